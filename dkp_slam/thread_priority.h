#pragma once

namespace dkp_slam {

/// Where there is too little time for all threads the calling one gets a tenth of what the others
/// do: nice 10, which anybody may ask for. Does nothing where priorities are those of processes.
void lower_priority();

}  // namespace dkp_slam

#pragma once

#include <map>
#include <string>
#include <vector>

namespace dkp_slam {

/// Columns of a timings.csv by name; what was not known is infinite. Throws `Error` for a line with
/// another number of fields than the header or something that is no number, and when there is no
/// frame.
std::map<std::string, std::vector<double>> read_timings(const std::string& csv);

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/system/config.h"

namespace dkp_slam {

/// The configuration for its own camera: options that count pixels or frames are written for images
/// 640 wide at 30 Hz, and are changed here, and nowhere else in the system, to what is the same
/// angle or time for `config.camera`. At 640 and 30 Hz nothing changes.
SlamConfig scaled_to_camera(const SlamConfig& config);

}  // namespace dkp_slam

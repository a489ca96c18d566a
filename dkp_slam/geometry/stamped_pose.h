#pragma once

#include <vector>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Where the camera was at one moment.
struct StampedPose {
  double timestamp = 0.0;  ///< seconds, the sensor's clock
  Se3 world_from_camera;   ///< maps camera coordinates to world coordinates, metres
};

/// Poses in the order of their time stamps, each stamp once.
using Trajectory = std::vector<StampedPose>;

}  // namespace dkp_slam

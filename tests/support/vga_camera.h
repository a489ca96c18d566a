#pragma once

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam::testing {

/// 640 x 480 without distortion, with the focal length (525 px) that a Kinect's maker gives.
inline Camera vga_camera() {
  Camera camera;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

}  // namespace dkp_slam::testing

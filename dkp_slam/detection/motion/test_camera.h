#pragma once

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// 320 x 240 without distortion.
inline Camera test_camera() {
  Camera camera;
  camera.name = "test";
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 260.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  return camera;
}

}  // namespace dkp_slam

#pragma once

#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam::viewer {

/// What a keyframe's depth image shows of the static world, as a Container: sections positions
/// (3 int16 each, millimetres in the camera frame) and colours (3 uint8, red, green, blue). Every
/// `step`-th pixel of every `step`-th row; masks, and edges where depth jumps, are left out.
std::string make_cloud(const FrameSnapshot& snapshot, const Camera& camera, int step = 6);

}  // namespace dkp_slam::viewer

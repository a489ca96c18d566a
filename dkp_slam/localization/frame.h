#pragma once

#include <optional>
#include <vector>

#include "dkp_slam/feature/frame_features.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A frame on its way through the tracker.
struct Frame {
  int index = -1;
  double timestamp = 0.0;  ///< seconds
  FrameFeatures features;
  std::vector<char> is_static;  ///< per feature: the dynamics room's verdict
  std::vector<int> landmark;    ///< per feature: id in the map, -1 for none
  /// Camera's motion since the frame before, where somebody measured it (the dynamics room does).
  std::optional<Se3> current_from_previous;
  Se3 camera_from_world;
  int reference_keyframe = -1;

  int tracked_landmarks() const {
    int n = 0;
    for (const int l : landmark) n += l >= 0;
    return n;
  }
};

}  // namespace dkp_slam

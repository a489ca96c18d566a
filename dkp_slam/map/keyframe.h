#pragma once

#include <map>
#include <vector>

#include "dkp_slam/feature/frame_features.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A frame that the map keeps: its static features, their landmarks, and its neighbours.
struct Keyframe {
  int id = -1;
  int map = 0;  ///< to which of the maps it belongs, see Map
  int frame_index = -1;
  double timestamp = 0.0;  ///< seconds
  Se3 camera_from_world;
  FrameFeatures features;
  std::vector<int> landmarks;    ///< per feature, -1 for none
  std::map<int, int> covisible;  ///< keyframe -> number of landmarks both see
  /// The keyframe it shared most landmarks with when added; without any, the one that the measured
  /// motion led there from. -1 for a map's first.
  int parent = -1;
  bool removed = false;  ///< then only its pose, relative to its parent, is left
  Se3 self_from_parent;  ///< valid once removed
};

}  // namespace dkp_slam

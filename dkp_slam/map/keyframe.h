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
  int parent = -1;               ///< the keyframe it shared most landmarks with when added
  bool removed = false;          ///< then only its pose, relative to its parent, is left
  Se3 self_from_parent;          ///< valid once removed
};

}  // namespace dkp_slam

#pragma once

#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A change of where things are, as the closing of a loop or an adjustment brings it.
struct MapMove {
  /// What lies about a keyframe moves with it. `world_after_from_before` maps the world's
  /// coordinates from before the move to those after it.
  struct Keyframe {
    int id = -1;
    Se3 world_after_from_before;
    Se3 camera_from_world;  ///< after the move; filled in by Map::move
  };
  /// A landmark that comes to lie in a place of its own.
  struct Landmark {
    int id = -1;
    Eigen::Vector3d position;  ///< world frame after the move, metres
  };
  std::vector<Keyframe> keyframes;  ///< ascending by id; removed ones are passed over
  /// Ascending by id. All others move with the first keyframe that sees them, if that moves.
  std::vector<Landmark> landmarks;
};

}  // namespace dkp_slam

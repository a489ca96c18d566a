#pragma once

#include <span>

#include "dkp_slam/dense/surface_mesh.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// A frame that stands upright: z up, the floor at 0, the origin below the first camera, x where it
/// looked.
struct LevelFrame {
  Se3 level_from_world;
  bool found = false;  ///< the floor; else up is the cameras' mean up, and 0 the lowest surface
};

/// Finds the floor: among the surfaces that face up, within 45 degrees of the cameras' mean up
/// (their -y), the direction that most of them share, and the lowest height at which a good part of
/// these lie. Throws `Error` without a pose or a surface.
LevelFrame find_level(const SurfaceMesh& mesh, std::span<const StampedPose> path);

}  // namespace dkp_slam

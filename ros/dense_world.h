#pragma once

#include <optional>
#include <vector>

#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_mesh.h"
#include "ros/node_options.h"
#include "ros/world.h"

namespace dkp_slam::ros1 {

/// The static world as it can be fused from keyframes, without what moves.
struct DenseWorld {
  SurfaceMesh surface;
  std::optional<OccupancyGrid> grid;  ///< nothing where no floor plan can be made of it yet
};

/// Fuses all frames anew at their poses, so that a closed loop moves what was fused before.
DenseWorld fuse(const std::vector<World::PosedFrame>& frames, const Camera& camera,
                const NodeOptions& options);

}  // namespace dkp_slam::ros1

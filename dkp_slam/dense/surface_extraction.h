#pragma once

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/surface_mesh.h"

namespace dkp_slam {

struct SurfaceOptions {
  /// Views that must have seen a surface at a place, less those that looked through it since.
  double least_views = 3.0;
  /// `least_views` where keyframes alone were fused, which are few.
  static constexpr double least_keyframes = 2.0;
  /// A place where so many views saw something in a mask for each that saw a surface there is no
  /// part of the static world: somebody who sits is not detected in every image.
  double moving_share = 0.3;
  /// Square metres of the smallest piece of surface that hangs together and is kept: smaller ones
  /// are noise in mid-air.
  double least_area = 0.02;
};

/// The surfaces of a dense map, one vertex in each cell between eight voxels that a surface goes
/// through (Gibson, "Constrained Elastic Surface Nets", MICCAI 1998, without relaxation): vertices
/// are as good as a point cloud of one point a voxel. Where only one side of a surface was ever
/// seen there is a surface; where nobody looked there is none, so that it has borders.
SurfaceMesh extract_surface(const DenseMap& map, const SurfaceOptions& options = {});

}  // namespace dkp_slam

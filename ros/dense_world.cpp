#include "ros/dense_world.h"

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/depth_view.h"
#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/error.h"

namespace dkp_slam::ros1 {

DenseWorld fuse(const std::vector<World::PosedFrame>& frames, const Camera& camera,
                const NodeOptions& options) {
  DepthViewOptions viewing;
  viewing.max_range = options.range;
  const DepthViewer viewer(camera, viewing);
  DenseMapOptions mapping;
  mapping.voxel = options.voxel;
  mapping.memory = 500.0;  // megabytes, on a robot
  DenseMap map(camera, mapping);
  FreeSpace free(camera, options.cell, 0.25 * mapping.memory);
  Trajectory path;
  for (const World::PosedFrame& f : frames) map.reserve(viewer.view(f.frame, f.world_from_camera));
  for (const World::PosedFrame& f : frames) {
    const StaticView view = viewer.view(f.frame, f.world_from_camera);
    map.fuse(view);
    free.add(view, map.options().truncation);
    path.push_back({f.frame.timestamp, f.world_from_camera});
  }
  SurfaceOptions extraction;
  extraction.least_views = 2.0;  // keyframes are few
  DenseWorld world;
  world.surface = extract_surface(map, extraction);
  if (world.surface.vertices.empty()) return world;
  GridOptions band;
  band.low = options.low;
  band.high = options.high;
  band.cell = options.cell;
  try {
    world.grid = make_grid(world.surface, free, find_level(world.surface, path), band);
  } catch (const Error&) {  // nothing was seen in the band yet
  }
  return world;
}

}  // namespace dkp_slam::ros1

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dkp_slam/dense/block_grid.h"
#include "dkp_slam/dense/depth_view.h"
#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

struct DenseMapOptions {
  double voxel = 0.02;  ///< metres, 0.005 to 0.2
  /// Metres before and behind a surface in which depth counts: twice the noise at the range's
  /// end. At least 3 voxels are taken.
  double truncation = 0.08;
  /// Share of what a voxel holds that is lost with every view through it.
  double forgetting = 0.1;
  /// Views that count at most, so that what stood for long can go, too.
  double most_views = 100.0;
  double memory = 2000.0;  ///< megabytes that voxels may take
};

/// A sample of the truncated signed distance field, at cell * voxel metres in the world frame.
struct Voxel {
  float distance =
      0.0F;  ///< metres to the nearest surface, positive before it; mean of what was seen
  float weight = 0.0F;        ///< of that mean: sum of inverse variances of depth, 1 at 0.5 m
  float hits = 0.0F;          ///< views that saw a surface at this place
  float seen_through = 0.0F;  ///< views that saw something behind this place
  float moving = 0.0F;        ///< views that saw something in a mask at this place
  std::uint16_t colour[3] = {0, 0, 0};  ///< BGR, 1/256 grey levels; mean
  std::uint16_t colours = 0;            ///< views in that mean
};

/// A truncated signed distance field of the static world, fused from depth images whose poses are
/// known (Curless and Levoy, "A Volumetric Method for Building Complex Models from Range Images",
/// SIGGRAPH 1996). Free space is carved: where a view looks through a voxel, what it held before
/// loses weight. What was fused does not move and cannot be taken out again, for what was carved
/// away is forgotten: where poses have changed, blocks are cleared and fused anew (KeyframeFusion).
///
/// Same views in the same order, same bytes, on any number of threads.
class DenseMap {
 public:
  /// Throws `Error` for options that make no sense.
  explicit DenseMap(const Camera& camera, const DenseMapOptions& options = {});

  /// Makes room along the surfaces of a view. To be called for all views before the first is fused:
  /// then a voxel is told also of the views through it before something appeared there.
  void reserve(const StaticView& view);
  /// Fuses a view where room was made.
  void fuse(const StaticView& view);
  /// The same for some blocks alone, by the calling thread alone.
  void fuse(const StaticView& view, std::span<const std::size_t> blocks);

  /// Those of `blocks` that a camera there may change, with nothing known beyond `farthest` metres.
  std::vector<std::size_t> in_view(const Se3& world_from_camera, double farthest,
                                   std::span<const std::size_t> blocks) const;
  /// Forgets what was fused into a block.
  void clear(std::size_t block);

  const DenseMapOptions& options() const { return options_; }
  const BlockGrid<Voxel>& voxels() const { return grid_; }
  double megabytes() const;
  /// Memory has run out: surfaces are missing.
  bool full() const { return full_; }

 private:
  struct Projection;
  void fuse_block(const Projection& to, std::size_t block);
  void see_through(Voxel& voxel) const;
  void see_moving(Voxel& voxel) const;
  void see_surface(Voxel& voxel, float distance, float weight) const;

  Camera camera_;
  DenseMapOptions options_;
  BlockGrid<Voxel> grid_;
  bool full_ = false;
};

}  // namespace dkp_slam

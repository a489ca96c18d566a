#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/free_space.h"
#include "dkp_slam/dense/live/live_dense_map.h"
#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/system/config.h"
#include "python/src/arrays.h"

namespace dkp_slam::python {

/// What Python may ask of how a dense map is made, checked. Metres and megabytes.
struct DenseSettings {
  double voxel = 0.02, range = 5.0, cell = 0.05, memory = 2000.0;

  /// Throws ValueError, which names the argument and its bounds.
  void check() const;
  DenseMapOptions map() const;
  DepthViewOptions view() const;
  /// Megabytes of free space: what `memory` has on top.
  double memory_of_free_space() const;
};

/// What is fused, as long as somebody looks at it: the voxels, the free space (may be null) and the
/// poses of what was fused.
using UseDense = std::function<void(const DenseMap&, const FreeSpace*, const Trajectory& path)>;

/// Something that has a dense map to be looked at. Without the GIL.
class DenseReader {
 public:
  explicit DenseReader(SurfaceOptions surface) : surface_(surface) {}
  virtual ~DenseReader() = default;
  /// False where nothing is fused (yet). `which`: of a run with several maps; none: the largest.
  virtual bool look(std::optional<int> which, const UseDense& use) = 0;
  const SurfaceOptions& surface() const { return surface_; }

 private:
  const SurfaceOptions surface_;
};

/// dkp_slam.DenseMap: images of any source at poses that are known.
class FusedReader final : public DenseReader {
 public:
  FusedReader(const Camera& camera, const DenseSettings& settings);
  /// Throws `Error` for images that do not fit.
  void reserve(const RgbdFrame& frame, const Se3& pose);
  void fuse(const RgbdFrame& frame, const Se3& pose);
  bool look(std::optional<int> which, const UseDense& use) override;
  const Camera& camera() const { return viewer_.camera(); }
  std::size_t images() const;

 private:
  const DepthViewer viewer_;
  mutable std::mutex mutex_;  // guards what follows; never held with the GIL wanted
  DenseMap map_;
  FreeSpace free_;
  Trajectory path_;
};

/// dkp_slam.LiveDenseMap: the keyframes of a run, fused while it lasts.
class LiveReader final : public DenseReader {
 public:
  LiveReader(const SlamConfig& config, const DenseSettings& settings, int keyframes);
  bool look(std::optional<int> which, const UseDense& use) override;
  const std::shared_ptr<LiveDenseMap>& map() const { return map_; }

 private:
  const std::shared_ptr<LiveDenseMap> map_;
};

}  // namespace dkp_slam::python

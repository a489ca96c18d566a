#include "apps/run_dense.h"

#include <spdlog/spdlog.h>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"

namespace dkp_slam::apps {
namespace {

LiveDenseOptions live_options(const DenseFiles& files, const SlamConfig& config) {
  LiveDenseOptions options;
  options.fusion.map = files.map;
  options.fusion.view = files.view;
  options.fusion.cell = files.needs_free_space() ? files.band.cell : 0.0;
  options.live = config.realtime;
  // Two pixels of a half-size image lie about 2 cm apart at the range's end.
  constexpr double fine = 0.015;  // metres
  if (files.map.voxel < fine) options.width = config.camera.width;
  return options;
}

}  // namespace

RunDense::RunDense(const DenseFiles& files, const SlamConfig& config)
    : files_(files),
      dense_(std::make_shared<LiveDenseMap>(config.camera, live_options(files, config))) {
  files_.surface.least_views = SurfaceOptions::least_keyframes;
  if (config.dynamics.mode == DynamicsMode::off) {
    spdlog::warn("mode off masks nothing: people are fused, too");
  }
}

void RunDense::join(Slam& slam) const { slam.add_observer(dense_, LiveDenseMap::watching()); }

void RunDense::write() const {
  dense_->finish();
  const bool there = dense_->look(dense_->largest_map(), [&](const KeyframeFusion& fused) {
    const Trajectory path = fused.path();
    write_dense_files(files_, fused.map(), fused.free(), path, path.size());
  });
  if (!there) throw Error("no keyframe was fused: nothing of the static world is written");
}

}  // namespace dkp_slam::apps

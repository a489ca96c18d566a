#include "python/src/dense_object.h"

#include <utility>

#include <fmt/format.h>

namespace dkp_slam::python {
namespace {

void check_between(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return;
  value_error(fmt::format("{} is {:g}; it must be from {:g} to {:g}", name, value, least, most));
}

SurfaceOptions surface_of_keyframes() { return {.least_views = SurfaceOptions::least_keyframes}; }

LiveDenseOptions live_options(const SlamConfig& config, const DenseSettings& settings,
                              int keyframes) {
  LiveDenseOptions options;
  options.fusion.map = settings.map();
  options.fusion.view = settings.view();
  options.fusion.cell = settings.cell;
  options.keyframes = keyframes;
  options.live = config.realtime;
  // Two pixels of a half-size image lie about 2 cm apart at the range's end.
  constexpr double fine = 0.015;  // metres
  if (settings.voxel < fine) options.width = config.camera.width;
  return options;
}

}  // namespace

void DenseSettings::check() const {
  check_between("voxel", voxel, 0.005, 0.2);
  check_between("range", range, 0.5, 100.0);
  check_between("cell", cell, 0.01, 1.0);
  check_between("memory", memory, 1.0, 1e6);
}

DenseMapOptions DenseSettings::map() const {
  DenseMapOptions options;
  options.voxel = voxel;
  options.memory = memory;
  return options;
}

DepthViewOptions DenseSettings::view() const {
  DepthViewOptions options;
  options.max_range = range;
  return options;
}

double DenseSettings::memory_of_free_space() const {
  constexpr double share = 0.25;
  return share * memory;
}

FusedReader::FusedReader(const Camera& camera, const DenseSettings& settings)
    : DenseReader(SurfaceOptions()),
      viewer_(camera, settings.view()),
      map_(camera, settings.map()),
      free_(camera, settings.cell, settings.memory_of_free_space()) {}

void FusedReader::reserve(const RgbdFrame& frame, const Se3& pose) {
  const StaticView view = viewer_.view(frame, pose);
  const std::lock_guard lock(mutex_);
  map_.reserve(view);
}

void FusedReader::fuse(const RgbdFrame& frame, const Se3& pose) {
  const StaticView view = viewer_.view(frame, pose);
  const std::lock_guard lock(mutex_);
  map_.reserve(view);
  map_.fuse(view);
  free_.add(view, map_.options().truncation);
  path_.push_back({frame.timestamp, pose});
}

std::size_t FusedReader::images() const {
  const std::lock_guard lock(mutex_);
  return path_.size();
}

bool FusedReader::look(std::optional<int>, const UseDense& use) {
  const std::lock_guard lock(mutex_);
  if (path_.empty()) return false;
  use(map_, &free_, path_);
  return true;
}

LiveReader::LiveReader(const SlamConfig& config, const DenseSettings& settings, int keyframes)
    : DenseReader(surface_of_keyframes()),
      map_(std::make_shared<LiveDenseMap>(config.camera,
                                          live_options(config, settings, keyframes))) {}

bool LiveReader::look(std::optional<int> which, const UseDense& use) {
  return map_->look(which.value_or(map_->largest_map()), [&](const KeyframeFusion& fused) {
    use(fused.map(), fused.free(), fused.path());
  });
}

}  // namespace dkp_slam::python

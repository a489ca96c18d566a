#include "dkp_slam/system/scaled_config.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

constexpr int least_levels = 3;

}  // namespace

SlamConfig scaled_to_camera(const SlamConfig& config) {
  const SensorScale scale = SensorScale::of(config.camera);
  SlamConfig scaled = config;
  // The pyramid's coarsest level sees the same angle: beyond it a small image has no corners that
  // are worth it, and a large one loses sight of what is near.
  scaled.orb.levels = std::max(least_levels, config.orb.levels + static_cast<int>(std::lround(
                                                 std::log(scale.pixels) /
                                                 std::log(config.orb.scale))));
  // What a pixel's noise stands for (blur, lens, shutter, where a corner is) is an angle too.
  scaled.measurement.pixel_sigma = scale.pixels * config.measurement.pixel_sigma;
  // How far off a camera's predicted motion is, is an angle, and grows with the time between frames.
  scaled.tracker.motion_radius =
      static_cast<float>(scale.per_frame(scale.pixels * config.tracker.motion_radius));
  MapperOptions& mapper = scaled.back_end.mapper;
  mapper.bundle_delay = scale.frames_of(config.back_end.mapper.bundle_delay);
  mapper.full.delay = scale.frames_of(config.back_end.mapper.full.delay);
  return scaled;
}

}  // namespace dkp_slam

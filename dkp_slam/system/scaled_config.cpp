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
  if (scale.pixels < 1.0) {
    // What the pixel noise stands for (blur, lens, depth read beside the corner) is an angle, and
    // levels coarser than the last one's angle at 640 have no corners that are worth it. A larger
    // image shows its corners as sharply as it can: there both stay (measured: 1280 with twice the
    // noise and four more levels has 1.6 times the error).
    scaled.measurement.pixel_sigma = scale.pixels * config.measurement.pixel_sigma;
    const double levels_less = std::log(1.0 / scale.pixels) / std::log(config.orb.scale);
    scaled.orb.levels = std::max(std::min(least_levels, config.orb.levels),
                                 config.orb.levels - static_cast<int>(std::lround(levels_less)));
  }
  // How far off a camera's predicted motion is, is an angle, and grows with the time between
  // frames.
  scaled.tracking.motion_radius =
      static_cast<float>(scale.per_frame(scale.pixels * config.tracking.motion_radius));
  scaled.mapping.bundle_delay = scale.frames_of(config.mapping.bundle_delay);
  scaled.mapping.full.delay = scale.frames_of(config.mapping.full.delay);
  return scaled;
}

}  // namespace dkp_slam

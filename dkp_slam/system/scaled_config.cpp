#include "dkp_slam/system/scaled_config.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

constexpr int least_levels = 3;
/// Enlarged further an image shows no corner more, and takes four times the time.
constexpr double most_enlargement = 2.0;

/// Corners of an image narrower than 640 pixels: it is enlarged to that width. The levels coarser
/// than the last one's angle at 640, which have no corners that are worth it, go where even the
/// enlarged one is smaller.
void scale_features(double pixels, OrbOptions& orb) {
  const double enlargement = std::min(1.0 / pixels, most_enlargement);
  const double levels_less = std::log(1.0 / (pixels * enlargement)) / std::log(orb.scale);
  orb.enlargement *= enlargement;
  orb.levels = std::max(std::min(least_levels, orb.levels),
                        orb.levels - static_cast<int>(std::lround(levels_less)));
}

/// What pixels mean in an image narrower than 640.
void scale_pixels(double pixels, DynamicsOptions& dynamics) {
  // Flow misses a static point by an angle (blur, depth beside the corner) and by a share of a
  // pixel (its own noise): with half the pixels it is between half and all of that
  // many. Measured at 320 and 15 Hz: the error on the whole is that of unscaled thresholds, within
  // 5%.
  const double noise = std::sqrt(pixels);
  const auto narrow = [noise](auto& threshold) {
    threshold = static_cast<std::remove_reference_t<decltype(threshold)>>(noise * threshold);
  };
  narrow(dynamics.removal.residual);
  narrow(dynamics.removal.residual_long);
  narrow(dynamics.surfaces.moving_short);
  narrow(dynamics.surfaces.moving_long);
  narrow(dynamics.surfaces.still_long);
  // How ragged depth is beside an edge, and how far colour moves until depth is read, are angles.
  // But masks are known to a pixel of any image: their margin stays.
  dynamics.motion.min_lag_pixels *= pixels;
  dynamics.motion.max_lag_pixels *= pixels;
}

}  // namespace

SlamConfig scaled_to_camera(const SlamConfig& config) {
  const SensorScale scale = SensorScale::of(config.camera);
  SlamConfig scaled = config;
  scaled.dynamics.removal.depth_margin =
      cvRound(scale.pixels * config.dynamics.removal.depth_margin);
  scaled.refill.margin = cvRound(scale.pixels * config.refill.margin);
  scaled.refill.known_inside = cvRound(scale.pixels * config.refill.known_inside);
  if (scale.pixels < 1.0) {
    // What the pixel noise stands for (blur, lens, depth read beside the corner) is an angle. A
    // larger image shows its corners as sharply as it can: there it stays (measured: 1280 with
    // twice the noise and four more levels has 1.6 times the error).
    scaled.measurement.pixel_sigma = scale.pixels * config.measurement.pixel_sigma;
    scale_features(scale.pixels, scaled.orb);
    scale_pixels(scale.pixels, scaled.dynamics);
  }
  // How far off a camera's predicted motion is, is an angle, and grows with the time between
  // frames.
  scaled.tracking.motion_radius =
      static_cast<float>(scale.per_frame(scale.pixels * config.tracking.motion_radius));
  // Frames that are kept must reach over the long baseline.
  FlowOptions& flow = scaled.dynamics.motion.flow;
  flow.history = std::max(flow.history, scale.frames_of(flow.history));
  scaled.mapping.bundle_delay = scale.frames_of(config.mapping.bundle_delay);
  scaled.mapping.full.delay = scale.frames_of(config.mapping.full.delay);
  return scaled;
}

}  // namespace dkp_slam

#include "dkp_slam/sensor/synthetic/source.h"

#include <cmath>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/synthetic/kinect_noise.h"

namespace dkp_slam {
namespace {

constexpr double first_stamp = 1000.0;  // seconds; 0 would hide errors of time arithmetic
constexpr double image_noise = 1.5;     // grey levels, a consumer camera's in a lit room

}  // namespace

Camera SyntheticOptions::default_camera() {
  Camera camera;
  camera.name = "synthetic";
  camera.fx = 535.4;
  camera.fy = 539.2;
  camera.cx = 320.1;
  camera.cy = 247.6;
  return camera;
}

SyntheticOptions synthetic_scenario(const std::string& name) {
  SyntheticOptions options;
  if (name == "walking_halfsphere") {
    options.motion = SyntheticMotion::halfsphere;
  } else if (name == "walking_static") {
    options.motion = SyntheticMotion::still;
  } else if (name == "static_xyz") {
    options.people = 0;
  } else if (name != "walking_xyz") {
    throw Error(
        fmt::format("no scenario \"{}\"; there are walking_xyz, walking_halfsphere, "
                    "walking_static and static_xyz",
                    name));
  }
  return options;
}

SyntheticSource::SyntheticSource(const SyntheticOptions& options)
    : options_(options), world_(options.seed, options.people) {
  if (const auto reason = options.camera.check()) throw Error("camera: " + *reason);
}

std::string SyntheticSource::description() const {
  return fmt::format("synthetic world, seed {}", options_.seed);
}

double SyntheticSource::timestamp(std::size_t index) const {
  constexpr double microseconds = 1e6;
  const double time = static_cast<double>(index) / options_.camera.frame_rate;
  return std::round((first_stamp + time) * microseconds) / microseconds;
}

Se3 SyntheticSource::world_from_camera(double timestamp) const {
  return camera_pose(options_.motion, options_.seed, timestamp - first_stamp);
}

std::optional<RgbdFrame> SyntheticSource::read() {
  if (next_ >= options_.frames) return std::nullopt;
  RgbdFrame frame;
  frame.index = static_cast<int>(next_);
  frame.timestamp = timestamp(next_);
  truth_.world_from_camera = world_from_camera(frame.timestamp);
  const Rendering seen =
      world_.render(options_.camera, truth_.world_from_camera, frame.timestamp - first_stamp);
  truth_.depth = seen.depth;
  truth_.mask = seen.mask;
  frame.colour = seen.colour;
  if (options_.kinect_noise) {
    // Each frame has a generator of its own, so that it does not depend on those before it.
    cv::RNG rng((options_.seed << 24U) + next_ + 1);
    frame.depth = kinect_depth(seen.depth, options_.camera, rng);
    add_image_noise(&frame.colour, image_noise, rng);
  } else {
    frame.depth = seen.depth.clone();
    frame.depth.setTo(
        0.0, (frame.depth < options_.camera.min_depth) | (frame.depth > options_.camera.max_depth));
  }
  ++next_;
  return frame;
}

}  // namespace dkp_slam

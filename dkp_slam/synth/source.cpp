#include "dkp_slam/synth/source.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/noise/kinect_noise.h"

namespace dkp_slam {
namespace {

constexpr double first_stamp = 1000.0;  // seconds; 0 would hide errors of time arithmetic
constexpr double exposure = 0.008;      // seconds, of a colour camera in a lit room

/// Boxes of everything in an image of instance numbers.
std::vector<SyntheticObject> objects_in(const cv::Mat& instance,
                                        const std::vector<std::shared_ptr<const Actor>>& actors) {
  struct Extent {
    int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1, pixels = 0;
  };
  std::vector<Extent> extents(actors.size());
  for (int y = 0; y < instance.rows; ++y) {
    const auto* row = instance.ptr<std::uint8_t>(y);
    for (int x = 0; x < instance.cols; ++x) {
      if (row[x] == 0) continue;
      Extent& e = extents.at(row[x] - 1U);
      e.left = std::min(e.left, x);
      e.right = std::max(e.right, x);
      e.top = std::min(e.top, y);
      e.bottom = std::max(e.bottom, y);
      ++e.pixels;
    }
  }
  std::vector<SyntheticObject> objects;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const Extent& e = extents[i];
    if (e.pixels == 0) continue;
    objects.push_back({static_cast<int>(i) + 1, actors[i]->class_name(),
                       cv::Rect(cv::Point(e.left, e.top), cv::Point(e.right + 1, e.bottom + 1)),
                       e.pixels});
  }
  return objects;
}

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
  options.scenario = name;
  options.frames = default_frames(name);
  return options;
}

SyntheticSource::SyntheticSource(const SyntheticOptions& options) : options_(options) {
  if (const auto reason = options.camera.check()) throw Error("camera: " + *reason);
  std::optional<RecordedMotion> recorded;
  // Before the scenario, which takes longer to make than a bad file to find.
  if (!options_.trajectory.empty()) recorded = recorded_motion(options_.trajectory);
  scenario_ = make_scenario(options_.scenario, options_.seed);
  if (recorded) scenario_.camera = recorded->motion;
  DepthCorrection off;
  off.distortion.coefficients = -options_.camera.depth_correction.distortion.coefficients;
  distorter_ = DepthCorrector(off, {options_.camera.width, options_.camera.height});
  plan_frames(recorded ? std::optional(recorded->duration) : std::nullopt);
  SensorOptions sensor;
  sensor.noise = options_.kinect_noise;
  sensor_.emplace(sensor, options_.seed);
}

void SyntheticSource::plan_frames(std::optional<double> duration) {
  const double rate = options_.camera.frame_rate;
  std::size_t& frames = options_.frames;
  constexpr double rounding = 1e-6;  // seconds
  const std::size_t possible =
      duration ? static_cast<std::size_t>((*duration + rounding) * rate) + 1 : frames;
  const std::size_t wanted = frames == 0 ? possible : frames;
  if (scenario_.drops_frames) {
    arriving_ = arriving_frames(wanted, rate, options_.seed);
  } else {
    arriving_.resize(wanted);
    std::iota(arriving_.begin(), arriving_.end(), std::size_t{0});
  }
  for (std::size_t& number : arriving_) number += options_.first_frame;
  if (duration && frames == 0) {
    arriving_.erase(std::lower_bound(arriving_.begin(), arriving_.end(), possible),
                    arriving_.end());
  }
  if (duration && !arriving_.empty() && arriving_.back() >= possible) {
    throw Error(fmt::format("{}: the path lasts {:.2f} s, which are {} frames; {} are too many",
                            options_.trajectory.string(), *duration, possible, frames));
  }
  frames = arriving_.size();
}

std::string SyntheticSource::description() const {
  return fmt::format("synthetic {}, seed {}", options_.scenario, options_.seed);
}

double SyntheticSource::timestamp(std::size_t index) const {
  constexpr double microseconds = 1e6;
  const double time = static_cast<double>(arriving_.at(index)) / options_.camera.frame_rate;
  return std::round((first_stamp + time) * microseconds) / microseconds;
}

Se3 SyntheticSource::world_from_camera(double timestamp) const {
  return scenario_.camera(timestamp - first_stamp);
}

cv::Mat SyntheticSource::sensed_depth(const cv::Mat& depth) const {
  cv::Mat sensed;
  if (options_.kinect_noise) {
    // Each frame has a generator of its own, so that it does not depend on those before it.
    cv::RNG rng((options_.seed << 24U) + arriving_[next_] + 1);
    sensed = kinect_depth(depth, options_.camera, rng);
  } else {
    sensed = depth.clone();
    sensed.setTo(0.0, (sensed < options_.camera.min_depth) | (sensed > options_.camera.max_depth));
  }
  const double bias = options_.camera.depth_correction.bias;
  if (bias != 0.0) cv::subtract(sensed, bias, sensed, sensed > 0.0);
  distorter_.apply(sensed);
  return sensed;
}

std::optional<RgbdFrame> SyntheticSource::read() {
  if (next_ >= options_.frames) return std::nullopt;
  if (!renderer_) {
    // To light the rooms takes seconds: not for those who only want to know the path.
    renderer_ =
        std::make_unique<const Renderer>(scenario_.place, scenario_.actors, scenario_.brightness);
  }
  RgbdFrame frame;
  frame.index = static_cast<int>(next_);
  frame.timestamp = timestamp(next_);
  RenderOptions rendering;
  rendering.exposure = exposure;
  rendering.readout = options_.camera.readout;
  const double time = frame.timestamp - first_stamp;
  const Rendering seen = renderer_->render(options_.camera, scenario_.camera, time, rendering);
  truth_.world_from_camera = scenario_.camera(time);
  truth_.depth = seen.depth;
  truth_.instance = seen.instance;
  // A picture of its own: assigned as it is, the comparison would be written into the last frame's,
  // which others may still be reading.
  truth_.mask = cv::Mat(seen.instance != 0);
  truth_.objects = objects_in(seen.instance, scenario_.actors);
  frame.colour = sensor_->expose(seen.radiance, time);
  cv::Mat later = seen.depth;
  const double depth_readout = options_.camera.readout_of_depth();
  const double delay = options_.camera.depth_correction.delay;
  if (delay != 0.0 || depth_readout != rendering.readout) {
    rendering.readout = depth_readout;
    rendering.samples = 1;  // more only make colours smoother
    later = renderer_->render(options_.camera, scenario_.camera, time + delay, rendering).depth;
  }
  frame.depth = sensed_depth(later);
  ++next_;
  return frame;
}

}  // namespace dkp_slam

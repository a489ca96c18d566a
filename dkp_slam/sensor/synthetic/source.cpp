#include "dkp_slam/sensor/synthetic/source.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/synthetic/kinect_noise.h"

namespace dkp_slam {
namespace {

constexpr double first_stamp = 1000.0;  // seconds; 0 would hide errors of time arithmetic

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
  scenario_ = make_scenario(options.scenario, options.seed);
  if (!options_.trajectory.empty()) follow(recorded_motion(options_.trajectory));
  if (scenario_.drops_frames) {
    arriving_ = arriving_frames(options_.frames, options_.camera.frame_rate, options_.seed);
  }
  renderer_ = std::make_unique<Renderer>(scenario_.place, scenario_.actors, scenario_.brightness);
}

}  // namespace dkp_slam

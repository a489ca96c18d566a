#include "dkp_slam/synth/tracing/actor_reach.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace dkp_slam {
namespace {

using Box = Eigen::AlignedBox3f;

/// Of each actor over the whole time.
std::vector<Box> boxes_of(const EmbreeScene& scene) {
  std::vector<Box> boxes;
  for (int i = scene.still_surfaces(); i < scene.surfaces(); ++i) {
    const Surface& surface = scene.surface(i);
    boxes.resize(static_cast<std::size_t>(surface.instance), Box());
    Box& box = boxes.back();
    for (const auto* vertices : {&surface.first, &surface.middle.vertices, &surface.last}) {
      for (const Eigen::Vector3f& v : *vertices) box.extend(v);
    }
  }
  return boxes;
}

}  // namespace

ActorReach::ActorReach(const EmbreeScene& scene, const Camera& camera, const Shutter& shutter) {
  const int last = camera.height - 1;
  const cv::Rect image(0, 0, camera.width, camera.height);
  // Between the moments looked at the camera may sway, and lenses bend.
  const float margin = camera.distortion.none() ? 12.0F : 0.1F * static_cast<float>(camera.width);
  for (const Box& box : boxes_of(scene)) {
    if (box.isEmpty()) continue;
    Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F), high = -low;
    bool around = false;
    for (const CameraPlace* place :
         {&shutter.row(0).begin, &shutter.row(last / 2).middle, &shutter.row(last).end}) {
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3f point = box.corner(static_cast<Box::CornerType>(corner));
        constexpr float near_plane = 0.1F;
        around = around || place->depth(point) < near_plane;
        const Eigen::Vector2f at = place->project(point);
        const Eigen::Vector2f pixel(static_cast<float>(camera.fx * at.x() + camera.cx),
                                    static_cast<float>(camera.fy * at.y() + camera.cy));
        low = low.cwiseMin(pixel);
        high = high.cwiseMax(pixel);
      }
    }
    if (around) {
      actors_.push_back(image);
      continue;
    }
    const auto bounded = [](float v) { return static_cast<int>(std::clamp(v, -1e6F, 1e6F)); };
    const cv::Point top(bounded(low.x() - margin), bounded(low.y() - margin));
    const cv::Point end(bounded(high.x() + margin) + 1, bounded(high.y() + margin) + 1);
    actors_.push_back(cv::Rect(top, end) & image);
  }
}

bool ActorReach::touches(const cv::Rect& pixels) const {
  return std::any_of(actors_.begin(), actors_.end(),
                     [&](const cv::Rect& actor) { return !(actor & pixels).empty(); });
}

}  // namespace dkp_slam

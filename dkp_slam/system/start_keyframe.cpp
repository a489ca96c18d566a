#include "dkp_slam/system/start_keyframe.h"

#include <utility>

namespace dkp_slam {

void StartKeyframe::remember(const Frame& frame, const OrbFeatures& orb, const RgbdFrame& image) {
  OrbFeatures features;  // without the image, which they are made of
  features.keypoints = orb.keypoints;
  features.descriptors = orb.descriptors;
  start_ = Start{frame, std::move(features), image.depth, image.depth_delay};
}

bool StartKeyframe::waits_for(const Frame& frame) const {
  constexpr double longest = 0.2;  // seconds; over more a camera in a hand has changed its motion
  return start_ && frame.index == start_->frame.index + 1 &&
         frame.timestamp - start_->frame.timestamp < longest;
}

void StartKeyframe::correct(const Frame& next, const Se3& next_from_start) {
  const Start start = std::move(*std::exchange(start_, std::nullopt));
  const Camera& camera = map_.camera();
  const Vector6d velocity = next_from_start.log() / (next.timestamp - start.frame.timestamp);
  FrameFeatures features(start.orb, start.depth, camera, Se3::exp(start.depth_delay * velocity));
  if (camera.readout > 0.0) features.correct_rolling_shutter(camera, velocity);
  const int id = start.frame.reference_keyframe;
  Keyframe& keyframe = map_.keyframe(id);
  keyframe.features = features.subset(start.frame.is_static);
  const Se3 world_from_camera = keyframe.camera_from_world.inverse();
  for (std::size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    const int l = keyframe.landmarks[f];
    const float depth = keyframe.features.depth[f];
    if (l < 0 || depth <= 0.0F || map_.landmark(l).first_keyframe != id) continue;
    const cv::Point2f& p = keyframe.features.pixel[f];
    map_.landmark(l).position = world_from_camera * camera.unproject({p.x, p.y}, depth);
    map_.refresh_view(l);
  }
}

}  // namespace dkp_slam

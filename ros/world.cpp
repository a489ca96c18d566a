#include "ros/world.h"

#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam::ros1 {

World::World(const Camera& camera, int keyframes)
    : small_(resized(camera, camera.width / 2, camera.height / 2)),
      most_images_(static_cast<std::size_t>(keyframes)) {}

void World::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  if (!snapshot->result.keyframe) return;
  RgbdFrame small = snapshot->frame;
  const cv::Size size(small_.width, small_.height);
  cv::resize(snapshot->frame.colour, small.colour, size, 0, 0, cv::INTER_AREA);
  cv::resize(snapshot->frame.depth, small.depth, size, 0, 0, cv::INTER_NEAREST);
  small.mask = cv::Mat();
  if (!snapshot->dynamics.mask.empty()) {
    cv::resize(snapshot->dynamics.mask, small.mask, size, 0, 0, cv::INTER_NEAREST);
  }
  const std::lock_guard lock(mutex_);
  images_[small.index] = std::move(small);
  if (images_.size() <= most_images_) return;
  // Every second one of the older half goes: all of the room stays, what is long ago in wider
  // steps.
  auto image = images_.begin();
  for (std::size_t i = 0; i < most_images_ / 2; i += 2) {
    image = std::next(images_.erase(image));
  }
}

void World::on_map(const MapChange& change) {
  const std::lock_guard lock(mutex_);
  ++version_;
  for (const KeyframeState& k : change.keyframes) {
    keyframes_[k.id] = {k.map, k.frame_index, k.timestamp, k.camera_from_world.inverse()};
  }
  for (const int id : change.removed_keyframes) keyframes_.erase(id);
  for (const LandmarkState& l : change.landmarks) {
    landmarks_[l.id] = {l.position.cast<float>(), l.first_keyframe};
  }
  for (const int id : change.removed_landmarks) landmarks_.erase(id);
}

long World::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

Trajectory World::path(int map) const {
  const std::lock_guard lock(mutex_);
  Trajectory path;
  for (const auto& [id, k] : keyframes_) {
    if (k.map == map) path.push_back({k.timestamp, k.world_from_camera});
  }
  return path;
}

std::vector<Eigen::Vector3f> World::landmarks(int map) const {
  const std::lock_guard lock(mutex_);
  std::vector<Eigen::Vector3f> points;
  for (const auto& [id, landmark] : landmarks_) {
    // A keyframe that is gone was of the map that is kept longest: the first.
    const auto seen_by = keyframes_.find(landmark.first_keyframe);
    if ((seen_by == keyframes_.end() ? 0 : seen_by->second.map) == map)
      points.push_back(landmark.position);
  }
  return points;
}

std::vector<World::PosedFrame> World::frames(int map) const {
  const std::lock_guard lock(mutex_);
  std::vector<PosedFrame> frames;
  for (const auto& [id, k] : keyframes_) {
    const auto image = images_.find(k.frame_index);
    if (k.map == map && image != images_.end())
      frames.push_back({image->second, k.world_from_camera});
  }
  return frames;
}

}  // namespace dkp_slam::ros1

#include "ros/world.h"

namespace dkp_slam::ros1 {

void World::on_map(const MapChange& change) {
  const std::lock_guard lock(mutex_);
  ++version_;
  for (const KeyframeState& k : change.keyframes) {
    keyframes_[k.id] = {k.map, k.timestamp, k.camera_from_world.inverse()};
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

}  // namespace dkp_slam::ros1

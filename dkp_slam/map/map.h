#pragma once

#include <deque>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/map/keyframe.h"
#include "dkp_slam/map/landmark.h"

namespace dkp_slam {

/// Keyframes, landmarks and who sees what.
///
/// Locking rule: a map belongs to the tracking thread, and no other thread ever holds a reference
/// into it. Bundle adjustment works on a snapshot (BundleProblem) and its result is carried back by
/// the tracking thread; so there is nothing to lock, and the order of changes never varies.
class Map {
 public:
  Map(const Camera& camera, float level_scale, int levels);

  Keyframe& keyframe(int id) { return keyframes_[static_cast<std::size_t>(id)]; }
  const Keyframe& keyframe(int id) const { return keyframes_[static_cast<std::size_t>(id)]; }
  Landmark& landmark(int id) { return landmarks_[static_cast<std::size_t>(id)]; }
  const Landmark& landmark(int id) const { return landmarks_[static_cast<std::size_t>(id)]; }

  /// Ids of all keyframes run from 0 to this; removed ones among them.
  int keyframe_ids() const { return static_cast<int>(keyframes_.size()); }
  int landmark_ids() const { return static_cast<int>(landmarks_.size()); }
  int live_keyframes() const { return live_keyframes_; }
  int live_landmarks() const { return live_landmarks_; }

  /// Takes the keyframe's features and landmark ids, and enters the sightings.
  int add_keyframe(Keyframe keyframe);
  /// A new landmark, seen by one feature of one keyframe that has no landmark yet.
  int add_landmark(const Eigen::Vector3d& position, int keyframe, int feature);
  void add_sighting(int landmark, int keyframe, int feature);
  void remove_sighting(int landmark, int keyframe);
  void remove_landmark(int landmark);
  /// Gives `kept` all sightings of `dropped` where it has none of its own.
  void fuse_landmarks(int dropped, int kept);
  /// Forgets a keyframe's features; its pose stays known through its parent.
  void remove_keyframe(int keyframe);

  /// The landmark that stands for `id` now: itself, what it was fused into, or -1 if gone.
  int resolve(int id) const;

  /// Counts anew which keyframes share landmarks with this one (15 or more, or the best one).
  void update_covisibility(int keyframe);
  /// The keyframes that share most landmarks with this one, best first, at most `count`.
  std::vector<int> best_covisible(int keyframe, int count) const;

  /// The landmarks that these keyframes see, each once, in the order of their ids.
  std::vector<int> landmarks_of(const std::vector<int>& keyframes) const;

  /// Most typical descriptor, mean direction and distance range, from the present sightings.
  void refresh(int landmark);
  /// Pyramid level at which a landmark should appear from a distance, metres.
  int predicted_level(const Landmark& landmark, double distance) const;

  /// Pose of any keyframe, removed ones through their parents.
  Se3 keyframe_pose(int id) const;

  const Camera& camera() const { return camera_; }
  float scale_of(int level) const { return scales_[static_cast<std::size_t>(level)]; }
  int levels() const { return static_cast<int>(scales_.size()); }

 private:
  Camera camera_;
  std::vector<float> scales_;
  float log_scale_;
  std::deque<Keyframe> keyframes_;
  std::deque<Landmark> landmarks_;
  int live_keyframes_ = 0;
  int live_landmarks_ = 0;
};

}  // namespace dkp_slam

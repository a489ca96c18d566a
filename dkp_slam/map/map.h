#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/map/id_table.h"
#include "dkp_slam/map/keyframe.h"
#include "dkp_slam/map/landmark.h"
#include "dkp_slam/map/map_move.h"
#include "dkp_slam/map/map_parts.h"

namespace dkp_slam {

/// Keyframes, landmarks and who sees what.
///
/// It may hold several maps (an atlas; Campos et al. 2021, "ORB-SLAM3", section VI): where the
/// camera was lost for too long, another one begins, in a world frame of its own, until a known
/// place tells how the two lie to one another. Ids run through all of them, so that joining two
/// maps moves one and renames nothing. No landmark is seen from two maps, no covisibility leads
/// across.
///
/// Locking rule: a map belongs to the tracking thread, and no other thread ever holds a reference
/// into it. Bundle adjustment works on a snapshot (BundleProblem) and its result is carried back by
/// the tracking thread; so there is nothing to lock, and the order of changes never varies. Reading
/// a landmark may bring it up to date (see `move`), so that a copy belongs to one thread as well.
class Map {
 public:
  Map(const Camera& camera, float level_scale, int levels);
  /// A map from its parts, which `check` has nothing against: sightings, covisibility and what
  /// `refresh` knows are computed anew. Ids that are missing are those of removed keyframes, of
  /// which not even the pose is known any more, and of removed landmarks.
  explicit Map(MapParts parts);

  Keyframe& keyframe(int id) { return const_cast<Keyframe&>(std::as_const(*this).keyframe(id)); }
  const Keyframe& keyframe(int id) const {
    const int slot = slots_[static_cast<std::size_t>(id)];
    return slot < 0 ? gone_ : keyframes_[static_cast<std::size_t>(slot)];
  }
  /// Only while `has_landmark`: of a removed one nothing is kept.
  Landmark& landmark(int id) { return up_to_date(*landmarks_[id]); }
  const Landmark& landmark(int id) const { return up_to_date(*landmarks_[id]); }
  bool has_landmark(int id) const { return landmarks_.find(id) != nullptr; }
  /// Ids of all landmarks that have not been removed, ascending.
  std::vector<int> landmarks() const { return landmarks_.ids(); }

  /// Ids of all keyframes run from 0 to this; removed ones among them.
  int keyframe_ids() const { return static_cast<int>(slots_.size()); }
  int landmark_ids() const { return landmark_ids_; }
  int live_keyframes() const { return live_keyframes_; }
  int live_keyframes_in(int map) const { return live_in_map_[static_cast<std::size_t>(map)]; }
  int live_landmarks() const { return static_cast<int>(landmarks_.size()); }

  /// Maps begun so far, those joined to others among them; new keyframes go to the last.
  int maps() const { return static_cast<int>(live_in_map_.size()); }
  /// The map that new keyframes belong to.
  int current_map() const { return current_map_; }
  void set_current_map(int map) { current_map_ = map; }
  /// Begins another map and makes it the current one.
  int start_map();
  /// The keyframes of a map that have not been removed, ascending.
  std::vector<int> keyframes_in(int map) const;
  /// Joins map `from` to map `into`: moves its keyframes and landmarks there.
  void move_map(int from, int into, const Se3& into_from_from);

  /// Moves keyframes, and with them their landmarks. Takes time for the keyframes alone: a landmark
  /// follows when it is next asked for, or when its turn comes in `follow_moves`. Where it comes to
  /// lie does not depend on when that is.
  void move(MapMove move);
  /// Lets the next so many landmarks follow the moves so far; to be called again and again. True
  /// when none is left behind.
  bool follow_moves(std::size_t landmarks);

  /// Takes the keyframe's features and landmark ids, and enters the sightings.
  int add_keyframe(Keyframe keyframe);
  /// A new landmark, seen by one feature of one keyframe that has no landmark yet. Throws `Error`
  /// when no id is left (most_landmark_ids).
  int add_landmark(const Eigen::Vector3d& position, int keyframe, int feature);
  void add_sighting(int landmark, int keyframe, int feature);
  void remove_sighting(int landmark, int keyframe);
  void remove_landmark(int landmark);
  /// Gives `kept` all sightings of `dropped` where it has none of its own.
  void fuse_landmarks(int dropped, int kept);
  /// Forgets a keyframe's features; its pose stays known through its parent.
  void remove_keyframe(int keyframe);

  /// The landmark that stands for `id` now: itself, what it was fused into, or -1 if gone. Of those
  /// whose fusion has been forgotten -1 as well.
  int resolve(int id) const;
  /// Landmarks fused into others so far.
  std::int64_t fusions() const { return forgotten_fusions_ + std::int64_t(fused_.size()); }
  /// Forgets what the first so many were fused into: to be called when nobody holds their ids any
  /// more. In a room that is mapped over and over every sixth landmark ends in a fusion.
  void forget_fusions(std::int64_t first);

  /// Counts anew which keyframes share landmarks with this one (15 or more, or the best one).
  void update_covisibility(int keyframe);
  /// The keyframes that share most landmarks with this one, best first, at most `count`.
  std::vector<int> best_covisible(int keyframe, int count) const;

  /// The landmarks that these keyframes see, each once, in the order of their ids.
  std::vector<int> landmarks_of(const std::vector<int>& keyframes) const;

  /// Most typical descriptor, mean direction and distance range, from the present sightings.
  void refresh(int landmark);
  /// Of these only direction and range, which change when poses or the landmark move.
  void refresh_view(int landmark);
  /// Pyramid level at which a landmark should appear from a distance, metres.
  int predicted_level(const Landmark& landmark, double distance) const;

  /// Pose of any keyframe, removed ones through their parents.
  Se3 keyframe_pose(int id) const;

  /// What the map holds on the heap, bytes.
  std::size_t memory() const;

  const Camera& camera() const { return camera_; }
  float level_scale() const { return level_scale_; }
  float scale_of(int level) const { return scales_[static_cast<std::size_t>(level)]; }
  int levels() const { return static_cast<int>(scales_.size()); }

 private:
  /// A landmark that does not move in memory, and is copied with the map.
  struct LandmarkSlot : std::unique_ptr<Landmark> {
    LandmarkSlot() = default;
    explicit LandmarkSlot(Landmark landmark)
        : unique_ptr(std::make_unique<Landmark>(std::move(landmark))) {}
    LandmarkSlot(LandmarkSlot&&) = default;
    LandmarkSlot& operator=(LandmarkSlot&&) = default;
    LandmarkSlot(const LandmarkSlot& other)
        : unique_ptr(other ? std::make_unique<Landmark>(*other) : nullptr) {}
    LandmarkSlot& operator=(const LandmarkSlot& other) { return *this = LandmarkSlot(other); }
  };

  Landmark& up_to_date(Landmark& landmark) const {
    if (landmark.followed_moves != moves_) follow_moves(landmark);
    return landmark;
  }
  void follow_moves(Landmark& landmark) const;
  void follow(const MapMove& move, Landmark& landmark) const;
  /// The first sighting's level and distance fix the range of scales.
  void set_range(Landmark& landmark, const Se3& first_camera_from_world) const;

  /// Landmarks that make two keyframes neighbours, as in ORB-SLAM.
  static constexpr int least_shared = 15;
  /// Other keyframe -> number of landmarks both see, at this moment.
  std::map<int, int> shared_landmarks(int keyframe) const;

  Camera camera_;
  float level_scale_;
  std::vector<float> scales_;
  float log_scale_;
  std::deque<Keyframe> keyframes_;
  std::vector<int> slots_;  // by id: where in `keyframes_`; -1 for those gone before it was loaded
  Keyframe gone_;           // stands for them
  IdTable<LandmarkSlot> landmarks_;
  IdTable<int> replaced_by_;  // the landmark that one was fused into
  std::deque<int> fused_;     // whose fusion is known, in the order in which they were fused
  std::int64_t forgotten_fusions_ = 0;
  int moves_ = 0;                         // made so far
  std::deque<MapMove> unfollowed_moves_;  // the last ones, which some landmark may have to follow
  int next_to_follow_ = 0;                // landmark whose turn it is
  int landmark_ids_ = 0;
  int live_keyframes_ = 0;
  std::vector<int> live_in_map_ = {0};
  int current_map_ = 0;
};

}  // namespace dkp_slam

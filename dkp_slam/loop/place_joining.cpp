#include "dkp_slam/loop/place_joining.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace dkp_slam {

Frame frame_of(const Keyframe& k) {
  Frame frame;
  frame.index = k.frame_index;
  frame.timestamp = k.timestamp;
  frame.features = k.features;
  frame.is_static.assign(k.landmarks.size(), 1);
  frame.landmark.assign(k.landmarks.size(), -1);
  return frame;
}

void join_map_of(Map& map, int keyframe, int old, const Se3& keyframe_from_old) {
  const int here = map.keyframe(keyframe).map, there = map.keyframe(old).map;
  assert(here != there);
  const Se3 there_from_here = (keyframe_from_old * map.keyframe(old).camera_from_world).inverse() *
                              map.keyframe(keyframe).camera_from_world;
  const bool here_moves = here > there;
  const int moving = here_moves ? here : there;
  // Each map is a tree of keyframes: the root of one hangs on the other from now on.
  for (const int k : map.keyframes_in(moving)) {
    if (map.keyframe(k).parent < 0) map.keyframe(k).parent = here_moves ? old : keyframe;
  }
  if (here_moves) {
    map.move_map(here, there, there_from_here);
  } else {
    map.move_map(there, here, there_from_here.inverse());
  }
}

PlaceFusion::PlaceFusion(const Map& map, int keyframe, std::vector<int> seen, int neighbours)
    : keyframe_(keyframe),
      seen_(std::move(seen)),
      around_(map.best_covisible(keyframe, neighbours)) {
  around_.insert(around_.begin(), keyframe);
}

bool PlaceFusion::advance(Map& map, const MeasurementModel& model, int effort) {
  if (!fuse_seen(map, effort)) return false;
  for (; next_ < around_.size(); ++next_, fusion_.reset()) {
    const int k = around_[next_];
    if (map.keyframe(k).removed) continue;
    if (!fusion_) {
      if (effort <= 0) return false;
      effort -= 2 * effort::keyframe;
      map.update_covisibility(k);
      fusion_.emplace(map, k);
    }
    if (!fusion_->advance(map, model, effort)) return false;
    map.update_covisibility(k);
  }
  return true;
}

bool PlaceFusion::fuse_seen(Map& map, int& effort) {
  for (; next_seen_ < seen_.size(); ++next_seen_) {
    if (effort <= 0) return false;
    if (map.keyframe(keyframe_).removed) break;
    const int old = map.resolve(seen_[next_seen_]);
    if (old < 0) continue;
    const int present = map.keyframe(keyframe_).landmarks[next_seen_];
    if (present == old) continue;
    if (present >= 0) {
      map.fuse_landmarks(present, old);
    } else if (map.landmark(old).feature_in(keyframe_) < 0) {
      map.add_sighting(old, keyframe_, static_cast<int>(next_seen_));
      map.refresh(old);
    }
    effort -= effort::fusion;
  }
  return true;
}

void fuse_seen_again(Map& map, const MeasurementModel& model, int keyframe, std::vector<int> seen,
                     int neighbours) {
  PlaceFusion(map, keyframe, std::move(seen), neighbours)
      .advance(map, model, std::numeric_limits<int>::max());
}

}  // namespace dkp_slam

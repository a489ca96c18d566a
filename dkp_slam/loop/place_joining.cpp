#include "dkp_slam/loop/place_joining.h"

#include <algorithm>
#include <cassert>

#include "dkp_slam/mapping/landmark_fusion.h"

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

void join_map_of(Map& map, int keyframe, int old, const Frame& seen) {
  const int here = map.keyframe(keyframe).map, there = map.keyframe(old).map;
  assert(here != there);
  const Se3 there_from_here =
      seen.camera_from_world.inverse() * map.keyframe(keyframe).camera_from_world;
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

void fuse_seen_again(Map& map, const MeasurementModel& model, int keyframe, const Frame& seen,
                     int neighbours) {
  const std::vector<int> around = map.best_covisible(keyframe, neighbours);
  for (std::size_t f = 0; f < seen.landmark.size(); ++f) {
    const int old = map.resolve(seen.landmark[f]);
    if (old < 0) continue;
    const int present = map.keyframe(keyframe).landmarks[f];
    if (present == old) continue;
    if (present >= 0) {
      map.fuse_landmarks(present, old);
    } else if (map.landmark(old).feature_in(keyframe) < 0) {
      map.add_sighting(old, keyframe, static_cast<int>(f));
      map.refresh(old);
    }
  }
  map.update_covisibility(keyframe);
  fuse_with_neighbours(map, model, keyframe);
  map.update_covisibility(keyframe);
  for (const int n : around) {
    map.update_covisibility(n);
    fuse_with_neighbours(map, model, n);
    map.update_covisibility(n);
  }
}

}  // namespace dkp_slam

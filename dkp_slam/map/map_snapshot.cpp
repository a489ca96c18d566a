#include "dkp_slam/map/map_snapshot.h"

#include <algorithm>
#include <cstddef>

namespace dkp_slam {
namespace {

/// A landmark without what follows from the keyframes.
Landmark stripped(const Landmark& l) {
  Landmark out;
  out.id = l.id;
  out.position = l.position;
  out.first_keyframe = l.first_keyframe;
  out.visible = l.visible;
  out.found = l.found;
  out.dynamic_log_odds = l.dynamic_log_odds;
  return out;
}

MapParts empty_parts(const Map& map) {
  MapParts parts;
  parts.camera = map.camera();
  parts.level_scale = map.level_scale();
  parts.levels = map.levels();
  return parts;
}

}  // namespace

std::vector<int> live_ancestors(const Map& map) {
  constexpr int unknown = -2;
  const auto at = [](int id) { return static_cast<std::size_t>(id); };
  std::vector<int> ancestor(at(map.keyframe_ids()), unknown);
  std::vector<int> path;
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    int found = k;
    path.clear();
    while (found >= 0 && map.keyframe(found).removed && ancestor[at(found)] == unknown) {
      path.push_back(found);
      found = map.keyframe(found).parent;
    }
    if (found >= 0 && map.keyframe(found).removed) found = ancestor[at(found)];
    for (const int p : path) ancestor[at(p)] = found;
    if (!map.keyframe(k).removed) ancestor[at(k)] = k;
  }
  return ancestor;
}

MapParts parts_of(const Map& map) {
  MapParts parts = empty_parts(map);
  parts.keyframe_ids = map.keyframe_ids();
  parts.landmark_ids = map.landmark_ids();
  parts.maps = map.maps();
  parts.current_map = map.current_map();
  const std::vector<int> ancestor = live_ancestors(map);
  for (int id = 0; id < map.keyframe_ids(); ++id) {
    const Keyframe& k = map.keyframe(id);
    if (k.removed) continue;
    parts.keyframes.push_back(k);
    parts.keyframes.back().covisible.clear();
    parts.keyframes.back().parent =
        k.parent < 0 ? -1 : ancestor[static_cast<std::size_t>(k.parent)];
  }
  for (const int id : map.landmarks()) parts.landmarks.push_back(stripped(map.landmark(id)));
  return parts;
}

Excerpt excerpt_of(const Map& map, int keyframe) {
  Excerpt excerpt{empty_parts(map), map.landmarks_of({keyframe})};
  const std::vector<int>& ids = excerpt.landmarks;
  Keyframe k = map.keyframe(keyframe);
  k.id = k.map = 0;
  k.parent = -1;
  k.covisible.clear();
  for (int& l : k.landmarks) {
    if (l >= 0) l = static_cast<int>(std::lower_bound(ids.begin(), ids.end(), l) - ids.begin());
  }
  excerpt.parts.keyframe_ids = 1;
  excerpt.parts.landmark_ids = static_cast<int>(ids.size());
  excerpt.parts.keyframes.push_back(std::move(k));
  for (const int id : ids) {
    Landmark l = stripped(map.landmark(id));
    l.id = static_cast<int>(excerpt.parts.landmarks.size());
    l.first_keyframe = 0;
    excerpt.parts.landmarks.push_back(std::move(l));
  }
  return excerpt;
}

}  // namespace dkp_slam

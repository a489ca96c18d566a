#include "dkp_slam/map/map_changes.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "dkp_slam/map/map_parts.h"

namespace dkp_slam {
namespace {

constexpr std::uint64_t absent = 0;

/// Of 64-bit words in their order. Every step can be undone when the word is known, so that a
/// change of one word always changes the result.
class Hash {
 public:
  void add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9E3779B97F4A7C15ULL;
    state_ ^= state_ >> 32;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(int a, int b) {
    add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 |
        static_cast<std::uint32_t>(b));
  }
  void add(const std::vector<int>& values) {
    std::size_t i = 0;
    for (; i + 2 <= values.size(); i += 2) {
      std::uint64_t word = 0;
      std::memcpy(&word, &values[i], sizeof(word));
      add(word);
    }
    if (i < values.size()) add(values[i], 0);
  }
  std::uint64_t value() const { return state_ == absent ? 1 : state_; }

 private:
  std::uint64_t state_ = 0x243F6A8885A308D3ULL;
};

std::uint64_t hash_of(const Keyframe& k, int parent) {
  Hash hash;
  for (const double v : k.camera_from_world.rotation.coeffs()) hash.add(v);
  for (const double v : k.camera_from_world.translation) hash.add(v);
  hash.add(k.map, parent);
  hash.add(k.landmarks);
  return hash.value();
}

std::uint64_t hash_of(const Landmark& l) {
  Hash hash;
  for (const double v : l.position) hash.add(v);
  hash.add(l.visible, l.found);
  hash.add(l.first_keyframe, std::bit_cast<int>(l.dynamic_log_odds));
  return hash.value();
}

}  // namespace

void ChangeFinder::find_keyframes(const Map& map, MapChange& change) {
  keyframes_.resize(static_cast<std::size_t>(map.keyframe_ids()), absent);
  const std::vector<int> ancestor = live_ancestors(map);
  for (int id = 0; id < map.keyframe_ids(); ++id) {
    const Keyframe& k = map.keyframe(id);
    std::uint64_t& known = keyframes_[static_cast<std::size_t>(id)];
    if (k.removed) {
      if (known != absent) change.removed_keyframes.push_back(id);
      known = absent;
      continue;
    }
    const int parent = k.parent < 0 ? -1 : ancestor[static_cast<std::size_t>(k.parent)];
    const std::uint64_t now = hash_of(k, parent);
    if (now == known) continue;
    if (known == absent) change.looks.push_back({id, k.features});
    known = now;
    change.keyframes.push_back(
        {id, k.map, k.frame_index, k.timestamp, k.camera_from_world, parent, k.landmarks});
  }
}

void ChangeFinder::find_landmarks(const Map& map, MapChange& change) {
  landmarks_.resize(static_cast<std::size_t>(map.landmark_ids()), absent);
  for (int id = 0; id < map.landmark_ids(); ++id) {
    std::uint64_t& known = landmarks_[static_cast<std::size_t>(id)];
    if (!map.has_landmark(id)) {
      if (known != absent) change.removed_landmarks.push_back(id);
      known = absent;
      continue;
    }
    const Landmark& l = map.landmark(id);
    const std::uint64_t now = hash_of(l);
    if (now == known) continue;
    known = now;
    change.landmarks.push_back(
        {id, l.position, l.first_keyframe, l.visible, l.found, l.dynamic_log_odds});
  }
}

void ChangeFinder::find_counts(const Map& map, MapChange& change) {
  std::set<int> live;
  for (int id = 0; id < map.keyframe_ids(); ++id) {
    if (!map.keyframe(id).removed) live.insert(map.keyframe(id).map);
  }
  change.keyframe_ids = map.keyframe_ids();
  change.landmark_ids = map.landmark_ids();
  change.maps = map.maps();
  change.current_map = map.current_map();
  change.live_maps.assign(live.begin(), live.end());
  change.counts_changed = first_ || change.keyframe_ids != keyframe_ids_ ||
                          change.landmark_ids != landmark_ids_ || change.maps != maps_ ||
                          change.current_map != current_map_ || change.live_maps != live_maps_;
  first_ = false;
  keyframe_ids_ = change.keyframe_ids;
  landmark_ids_ = change.landmark_ids;
  maps_ = change.maps;
  current_map_ = change.current_map;
  live_maps_ = change.live_maps;
}

MapChange ChangeFinder::find(const Map& map) {
  MapChange change;
  find_keyframes(map, change);
  find_landmarks(map, change);
  find_counts(map, change);
  return change;
}

}  // namespace dkp_slam

#include "dkp_slam/map/map_changes.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "dkp_slam/map/map_snapshot.h"

namespace dkp_slam {
namespace {

constexpr std::uint64_t absent = 0;
constexpr std::size_t ahead = 12;  // landmarks, from fetching one to looking at it

std::uint64_t mix(std::uint64_t state, std::uint64_t word) {
  state = (state ^ word) * 0x9E3779B97F4A7C15ULL;
  return state ^ state >> 32;
}

/// Hash of 64-bit words in their order. Every step can be undone when the word is known, so that a
/// change of one word always changes the result. Words go to four lanes in turn, which the
/// processor works on side by side.
template <class WordAt>
std::uint64_t hash_of(std::size_t words, const WordAt& word_at) {
  std::uint64_t a = 0x243F6A8885A308D3ULL, b = 0x13198A2E03707344ULL, c = 0xA4093822299F31D0ULL,
                d = 0x082EFA98EC4E6C89ULL + words;
  std::size_t i = 0;
  for (; i + 4 <= words; i += 4) {
    a = mix(a, word_at(i));
    b = mix(b, word_at(i + 1));
    c = mix(c, word_at(i + 2));
    d = mix(d, word_at(i + 3));
  }
  for (; i < words; ++i) a = mix(a, word_at(i));
  return a + std::rotl(b, 16) + std::rotl(c, 32) + std::rotl(d, 48);
}

std::uint64_t word_of(double value) { return std::bit_cast<std::uint64_t>(value); }

std::uint64_t word_of(int high, int low) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32 |
         static_cast<std::uint32_t>(low);
}

std::uint64_t present(std::uint64_t hash) { return hash == absent ? 1 : hash; }

std::uint64_t hash_of(const Keyframe& k, int parent) {
  const Eigen::Quaterniond& q = k.camera_from_world.rotation;
  const Eigen::Vector3d& t = k.camera_from_world.translation;
  const std::uint64_t state[] = {word_of(q.x()), word_of(q.y()),        word_of(q.z()),
                                 word_of(q.w()), word_of(t.x()),        word_of(t.y()),
                                 word_of(t.z()), word_of(k.map, parent)};
  const std::size_t pairs = k.landmarks.size() / 2;
  const std::uint64_t seen = hash_of(pairs, [&](std::size_t i) {
    std::uint64_t word = 0;
    std::memcpy(&word, &k.landmarks[2 * i], sizeof(word));
    return word;
  });
  const int odd_one = k.landmarks.size() % 2 == 1 ? k.landmarks.back() : 0;
  return present(mix(hash_of(8, [&](std::size_t i) { return state[i]; }), seen) +
                 static_cast<std::uint32_t>(odd_one));
}

std::uint64_t hash_of(const Landmark& l) {
  const std::uint64_t state[] = {word_of(l.position.x()), word_of(l.position.y()),
                                 word_of(l.position.z()), word_of(l.visible, l.found),
                                 word_of(l.first_keyframe, std::bit_cast<int>(l.dynamic_log_odds))};
  return present(hash_of(5, [&](std::size_t i) { return state[i]; }));
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
  for (const int id : landmarks_.ids()) {
    if (map.has_landmark(id)) continue;
    change.removed_landmarks.push_back(id);
    landmarks_.erase(id);
  }
  const std::vector<int> ids = map.landmarks();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + ahead < ids.size()) {
      // They lie all over the memory, and waiting for it is most of the work.
      __builtin_prefetch(&map.landmark(ids[i + ahead]).position);
      __builtin_prefetch(&map.landmark(ids[i + ahead]).first_keyframe);
    }
    const int id = ids[i];
    const Landmark& l = map.landmark(id);
    const std::uint64_t now = hash_of(l);
    const std::uint64_t* known = landmarks_.find(id);
    if (known && *known == now) continue;
    landmarks_.set(id, now);
    change.landmarks.push_back(
        {id, l.position, l.first_keyframe, l.visible, l.found, l.dynamic_log_odds});
  }
}

void ChangeFinder::find_counts(const Map& map, MapChange& change) {
  change.keyframe_ids = map.keyframe_ids();
  change.landmark_ids = map.landmark_ids();
  change.maps = map.maps();
  change.current_map = map.current_map();
  for (int which = 0; which < map.maps(); ++which) {
    if (map.live_keyframes_in(which) > 0) change.live_maps.push_back(which);
  }
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

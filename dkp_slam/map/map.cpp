#include "dkp_slam/map/map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/find_id.h"
#include "dkp_slam/map/id_map.h"

namespace dkp_slam {
namespace {

/// Whom a keyframe shares most landmarks with, the first of several.
std::map<int, int>::const_iterator most_shared(const std::map<int, int>& shared) {
  return std::max_element(shared.begin(), shared.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
}

}  // namespace

Map::Map(const Camera& camera, float level_scale, int levels)
    : camera_(camera), level_scale_(level_scale), log_scale_(std::log(level_scale)) {
  gone_.removed = true;
  float scale = 1.0F;
  for (int i = 0; i < levels; ++i, scale *= level_scale) scales_.push_back(scale);
}

Map::Map(MapParts parts) : Map(parts.camera, parts.level_scale, parts.levels) {
  live_in_map_.assign(static_cast<std::size_t>(parts.maps), 0);
  for (const Keyframe& k : parts.keyframes) ++live_in_map_[static_cast<std::size_t>(k.map)];
  current_map_ = parts.current_map;
  live_keyframes_ = static_cast<int>(parts.keyframes.size());
  landmark_ids_ = parts.landmark_ids;
  for (Landmark& l : parts.landmarks) {
    const int id = l.id;
    landmarks_.set(id, LandmarkSlot(std::move(l)));
  }
  slots_.assign(static_cast<std::size_t>(parts.keyframe_ids), -1);
  for (Keyframe& k : parts.keyframes) {
    for (std::size_t f = 0; f < k.landmarks.size(); ++f) {
      if (k.landmarks[f] >= 0)
        landmark(k.landmarks[f]).sightings.push_back({k.id, static_cast<int>(f)});
    }
    slots_[static_cast<std::size_t>(k.id)] = static_cast<int>(keyframes_.size());
    keyframes_.push_back(std::move(k));
  }
  for (Keyframe& k : keyframes_) {
    const std::map<int, int> shared = shared_landmarks(k.id);
    const auto best = most_shared(shared);
    for (auto it = shared.begin(); it != shared.end(); ++it) {
      if (it->second < least_shared && it != best) continue;
      k.covisible[it->first] = it->second;
      keyframe(it->first).covisible[k.id] = it->second;
    }
  }
  for (const int id : landmarks()) refresh(id);
}

int Map::start_map() {
  current_map_ = maps();
  live_in_map_.push_back(0);
  return current_map_;
}

std::vector<int> Map::keyframes_in(int map) const {
  std::vector<int> ids;
  for (const Keyframe& k : keyframes_) {
    if (k.map == map && !k.removed) ids.push_back(k.id);
  }
  return ids;
}

void Map::move_map(int from, int into, const Se3& into_from_from) {
  MapMove all;
  for (Keyframe& k : keyframes_) {
    if (k.map != from) continue;
    k.map = into;
    if (!k.removed) all.keyframes.push_back({k.id, into_from_from, {}});
  }
  move(std::move(all));
  live_in_map_[static_cast<std::size_t>(into)] += live_keyframes_in(from);
  live_in_map_[static_cast<std::size_t>(from)] = 0;
  if (current_map_ == from) current_map_ = into;
}

void Map::move(MapMove move) {
  for (MapMove::Keyframe& m : move.keyframes) {
    Keyframe& k = keyframe(m.id);
    if (k.removed) continue;
    k.camera_from_world = k.camera_from_world * m.world_after_from_before.inverse();
    m.camera_from_world = k.camera_from_world;
  }
  unfollowed_moves_.push_back(std::move(move));
  ++moves_;
  next_to_follow_ = 0;
}

bool Map::follow_moves(std::size_t landmarks) {
  if (unfollowed_moves_.empty()) return true;
  for (; landmarks > 0; --landmarks) {
    const int id = landmarks_.next(next_to_follow_);
    if (id < 0) {
      unfollowed_moves_.clear();
      return true;
    }
    up_to_date(*landmarks_[id]);
    next_to_follow_ = id + 1;
  }
  return false;
}

void Map::follow_moves(Landmark& l) const {
  const int first = moves_ - static_cast<int>(unfollowed_moves_.size());
  for (int m = l.followed_moves; m < moves_; ++m) {
    follow(unfollowed_moves_[static_cast<std::size_t>(m - first)], l);
  }
  l.followed_moves = moves_;
}

void Map::follow(const MapMove& move, Landmark& l) const {
  // From what the move holds alone: keyframes may have been moved on since.
  const Sighting& first = l.sightings.front();
  const MapMove::Keyframe* k = find_id(move.keyframes, first.keyframe);
  if (k) l.normal = k->world_after_from_before.rotation * l.normal;
  if (const MapMove::Landmark* own = find_id(move.landmarks, l.id)) {
    l.position = own->position;
    if (k) set_range(l, k->camera_from_world);
  } else if (k) {
    l.position = k->world_after_from_before * l.position;  // at its distance from the keyframe
  }
}

int Map::add_keyframe(Keyframe keyframe) {
  keyframe.id = keyframe_ids();
  keyframe.map = current_map_;
  slots_.push_back(static_cast<int>(keyframes_.size()));
  keyframes_.push_back(std::move(keyframe));
  ++live_keyframes_;
  ++live_in_map_[static_cast<std::size_t>(current_map_)];
  Keyframe& added = keyframes_.back();
  for (std::size_t f = 0; f < added.landmarks.size(); ++f) {
    const int landmark_id = added.landmarks[f];
    if (landmark_id < 0) continue;
    landmark(landmark_id).sightings.push_back({added.id, static_cast<int>(f)});
    refresh(landmark_id);
  }
  return added.id;
}

int Map::add_landmark(const Eigen::Vector3d& position, int keyframe_id, int feature) {
  if (landmark_ids_ >= most_landmark_ids) {
    throw Error(
        fmt::format("the map has given all its {} numbers for landmarks; end the run and go "
                    "on with its file, which numbers them anew",
                    most_landmark_ids));
  }
  const int id = landmark_ids_++;
  Landmark added;
  added.id = id;
  added.position = position;
  added.first_keyframe = keyframe_id;
  added.followed_moves = moves_;
  landmarks_.set(id, LandmarkSlot(std::move(added)));
  add_sighting(id, keyframe_id, feature);
  refresh(id);
  return id;
}

void Map::add_sighting(int landmark_id, int keyframe_id, int feature) {
  int& slot = keyframe(keyframe_id).landmarks[static_cast<std::size_t>(feature)];
  assert(slot < 0 && landmark(landmark_id).feature_in(keyframe_id) < 0);
  slot = landmark_id;
  auto& sightings = landmark(landmark_id).sightings;
  const auto after = std::upper_bound(sightings.begin(), sightings.end(), keyframe_id,
                                      [](int id, const Sighting& s) { return id < s.keyframe; });
  sightings.insert(after, {keyframe_id, feature});
}

void Map::remove_sighting(int landmark_id, int keyframe_id) {
  Landmark& l = landmark(landmark_id);
  const int feature = l.feature_in(keyframe_id);
  if (feature < 0) return;
  keyframe(keyframe_id).landmarks[static_cast<std::size_t>(feature)] = -1;
  std::erase_if(l.sightings, [&](const Sighting& s) { return s.keyframe == keyframe_id; });
  if (l.sightings.empty()) remove_landmark(landmark_id);
}

void Map::remove_landmark(int landmark_id) {
  if (!has_landmark(landmark_id)) return;
  for (const Sighting& s : landmark(landmark_id).sightings) {
    keyframe(s.keyframe).landmarks[static_cast<std::size_t>(s.feature)] = -1;
  }
  landmarks_.erase(landmark_id);
}

void Map::fuse_landmarks(int dropped, int kept) {
  assert(dropped != kept);
  const std::vector<Sighting> moved = landmark(dropped).sightings;
  Landmark& target = landmark(kept);
  target.found += landmark(dropped).found;
  target.visible += landmark(dropped).visible;
  target.dynamic_log_odds = std::max(target.dynamic_log_odds, landmark(dropped).dynamic_log_odds);
  remove_landmark(dropped);
  replaced_by_.set(dropped, kept);
  fused_.push_back(dropped);
  for (const Sighting& s : moved) {
    if (target.feature_in(s.keyframe) < 0) add_sighting(kept, s.keyframe, s.feature);
  }
  refresh(kept);
}

void Map::remove_keyframe(int keyframe_id) {
  Keyframe& k = keyframe(keyframe_id);
  assert(k.parent >= 0 && !k.removed);
  for (const int landmark_id : std::vector<int>(k.landmarks)) {
    if (landmark_id >= 0) remove_sighting(landmark_id, keyframe_id);
  }
  for (const auto& [other, shared] : k.covisible) keyframe(other).covisible.erase(keyframe_id);
  k.self_from_parent = k.camera_from_world * keyframe_pose(k.parent).inverse();
  k.covisible.clear();
  k.features = {};
  k.landmarks = std::vector<int>();  // "= {}" would keep the memory
  k.removed = true;
  --live_keyframes_;
  --live_in_map_[static_cast<std::size_t>(k.map)];
}

int Map::resolve(int id) const {
  while (id >= 0 && !has_landmark(id)) {
    const int* replacement = replaced_by_.find(id);
    id = replacement ? *replacement : -1;
  }
  return id;
}

void Map::forget_fusions(std::int64_t first) {
  for (; forgotten_fusions_ < first && !fused_.empty(); ++forgotten_fusions_) {
    replaced_by_.erase(fused_.front());
    fused_.pop_front();
  }
}

std::map<int, int> Map::shared_landmarks(int keyframe_id) const {
  std::map<int, int> shared;
  for (const int landmark_id : keyframe(keyframe_id).landmarks) {
    if (landmark_id < 0) continue;
    for (const Sighting& s : landmark(landmark_id).sightings) {
      if (s.keyframe != keyframe_id) ++shared[s.keyframe];
    }
  }
  return shared;
}

void Map::update_covisibility(int keyframe_id) {
  Keyframe& k = keyframe(keyframe_id);
  const std::map<int, int> shared = shared_landmarks(keyframe_id);
  for (const auto& [other, count] : k.covisible) keyframe(other).covisible.erase(keyframe_id);
  k.covisible.clear();
  const auto best = most_shared(shared);
  for (auto it = shared.begin(); it != shared.end(); ++it) {
    if (it->second < least_shared && it != best) continue;
    k.covisible[it->first] = it->second;
    keyframe(it->first).covisible[keyframe_id] = it->second;
  }
  if (k.parent < 0 && best != shared.end() && best->first < keyframe_id) k.parent = best->first;
}

std::vector<int> Map::best_covisible(int keyframe_id, int count) const {
  const auto& covisible = keyframe(keyframe_id).covisible;
  std::vector<std::pair<int, int>> order(covisible.begin(), covisible.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  if (static_cast<int>(order.size()) > count) order.resize(static_cast<std::size_t>(count));
  std::vector<int> ids;
  for (const auto& [id, shared] : order) ids.push_back(id);
  return ids;
}

std::vector<int> Map::landmarks_of(const std::vector<int>& keyframes) const {
  // Keyframes of one place share most of them: far fewer are left to sort than are met.
  IdSet met;
  std::vector<int> ids;
  for (const int k : keyframes) {
    for (const int l : keyframe(k).landmarks) {
      if (l >= 0 && met.insert(l)) ids.push_back(l);
    }
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

void Map::refresh(int landmark_id) {
  Landmark& l = landmark(landmark_id);
  if (l.sightings.empty()) return;
  std::vector<Descriptor> all;
  for (const Sighting& s : l.sightings) {
    const FrameFeatures& features = keyframe(s.keyframe).features;
    all.push_back(features.descriptor[static_cast<std::size_t>(s.feature)]);
  }
  // The descriptor whose median distance to the others is least.
  int best_median = 257;
  std::vector<int> distances(all.size());
  for (const Descriptor& candidate : all) {
    for (std::size_t i = 0; i < all.size(); ++i) distances[i] = hamming_distance(candidate, all[i]);
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>((all.size() - 1) / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      l.descriptor = candidate;
    }
  }
  refresh_view(landmark_id);
}

void Map::refresh_view(int landmark_id) {
  Landmark& l = landmark(landmark_id);
  if (l.sightings.empty()) return;
  l.normal.setZero();
  for (const Sighting& s : l.sightings) {
    const Se3& camera_from_world = keyframe(s.keyframe).camera_from_world;
    l.normal += (l.position - camera_from_world.inverse().translation).normalized();
  }
  l.normal.normalize();
  set_range(l, keyframe(l.sightings.front().keyframe).camera_from_world);
}

void Map::set_range(Landmark& l, const Se3& first_camera_from_world) const {
  const Sighting& first = l.sightings.front();
  const auto level =
      keyframe(first.keyframe).features.level[static_cast<std::size_t>(first.feature)];
  const auto distance = static_cast<float>((first_camera_from_world * l.position).norm());
  l.max_distance = distance * scale_of(level);
  l.min_distance = l.max_distance / scales_.back();
}

int Map::predicted_level(const Landmark& l, double distance) const {
  const auto ratio = static_cast<float>(l.max_distance / distance);
  const float level = std::ceil(std::log(ratio) / log_scale_);
  // As numbers, not yet as a level: a stored map can make them infinite, or none at all.
  return static_cast<int>(std::fmin(std::fmax(level, 0.0F), static_cast<float>(levels() - 1)));
}

std::size_t Map::memory() const {
  std::size_t bytes = landmarks_.memory() + replaced_by_.memory() + fused_.size() * sizeof(int) +
                      slots_.capacity() * sizeof(int);
  for (const int id : landmarks()) {
    bytes += sizeof(Landmark) + landmark(id).sightings.capacity() * sizeof(Sighting);
  }
  constexpr std::size_t tree_node = sizeof(std::pair<const int, int>) + 4 * sizeof(void*);
  for (const Keyframe& k : keyframes_) {
    bytes += sizeof(Keyframe) + k.features.memory() + k.landmarks.capacity() * sizeof(int) +
             k.covisible.size() * tree_node;
  }
  return bytes;
}

Se3 Map::keyframe_pose(int id) const {
  const Keyframe& k = keyframe(id);
  return k.removed ? k.self_from_parent * keyframe_pose(k.parent) : k.camera_from_world;
}

}  // namespace dkp_slam

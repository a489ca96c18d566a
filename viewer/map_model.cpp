#include "viewer/map_model.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam::viewer {
namespace {

constexpr std::size_t most_gone = 200'000;  // removed ones remembered

nlohmann::json pose_json(const Se3& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  const auto rounded = [](double value) {
    return std::isfinite(value) ? std::round(value * 1e6) / 1e6 : 0.0;
  };
  return {rounded(t.x()), rounded(t.y()), rounded(t.z()), rounded(q.x()),
          rounded(q.y()), rounded(q.z()), rounded(q.w())};
}

}  // namespace

void MapModel::add(const KeyframeSnapshot& keyframe) {
  ++version_;
  View& view = keyframes_[keyframe.id];
  view.map = keyframe.map;
  view.frame = keyframe.frame_index;
  view.time = keyframe.timestamp;
  view.world_from_camera = keyframe.world_from_camera;
  view.version = version_;
}

void MapModel::apply(const MapChange& change) {
  ++version_;
  for (const LandmarkState& l : change.landmarks) {
    Point& point = landmarks_[l.id];
    for (int i = 0; i < 3; ++i) point.position[i] = static_cast<float>(l.position[i]);
    point.first_keyframe = l.first_keyframe;
    point.version = version_;
  }
  for (const int id : change.removed_keyframes) {
    const auto found = keyframes_.find(id);
    if (found == keyframes_.end()) continue;
    forget_sightings(id, found->second);
    keyframes_.erase(found);
    bury(gone_keyframes_, id);
  }
  for (const KeyframeState& k : change.keyframes) {
    View& view = keyframes_[k.id];
    view.map = k.map;
    view.frame = k.frame_index;
    view.time = k.timestamp;
    view.world_from_camera = k.camera_from_world.inverse();
    view.parent = k.parent;
    view.version = version_;
    see(k.id, k.landmarks);
  }
  for (const KeyframeState& k : change.keyframes) count_neighbours(k.id, keyframes_[k.id]);
  for (const int id : change.removed_landmarks) {
    if (landmarks_.erase(id) > 0) bury(gone_landmarks_, id);
    seen_by_.erase(id);
  }
}

void MapModel::forget_sightings(int keyframe, const View& view) {
  for (const int l : view.landmarks) {
    const auto found = seen_by_.find(l);
    if (found == seen_by_.end()) continue;
    std::erase(found->second, keyframe);
    if (found->second.empty()) seen_by_.erase(found);
  }
}

void MapModel::see(int keyframe, const std::vector<int>& landmarks) {
  View& view = keyframes_[keyframe];
  forget_sightings(keyframe, view);
  view.landmarks.clear();
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(view.landmarks),
               [](int l) { return l >= 0; });
  std::sort(view.landmarks.begin(), view.landmarks.end());
  view.landmarks.erase(std::unique(view.landmarks.begin(), view.landmarks.end()),
                       view.landmarks.end());
  for (const int l : view.landmarks) seen_by_[l].push_back(keyframe);
}

void MapModel::count_neighbours(int keyframe, View& view) {
  std::unordered_map<int, int> shared;
  for (const int l : view.landmarks) {
    for (const int other : seen_by_[l]) ++shared[other];
  }
  shared.erase(keyframe);
  view.shared.assign(shared.begin(), shared.end());
  std::erase_if(view.shared, [](const auto& other) { return other.second < least_shared; });
  std::sort(view.shared.begin(), view.shared.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  if (view.shared.size() > most_neighbours) view.shared.resize(most_neighbours);
}

void MapModel::bury(std::deque<Gone>& gone, int id) {
  gone.push_back({version_, id});
  if (gone.size() > most_gone) {
    complete_since_ = std::max(complete_since_, gone.front().version);
    gone.pop_front();
  }
}

int MapModel::map_of(int id, const Point& point) const {
  const auto first = keyframes_.find(point.first_keyframe);
  if (first != keyframes_.end()) return first->second.map;
  const auto seen = seen_by_.find(id);
  if (seen == seen_by_.end() || seen->second.empty()) return 0;
  const auto other = keyframes_.find(seen->second.front());
  return other == keyframes_.end() ? 0 : other->second.map;
}

void MapModel::write(std::uint64_t since, nlohmann::json& head, Container& container) const {
  const bool reset = since == 0 || since < complete_since_ || since > version_;
  if (reset) since = 0;
  head["map"] = version_;
  head["map_reset"] = reset;
  nlohmann::json& keyframes = head["keyframes"] = nlohmann::json::array();
  for (const auto& [id, view] : keyframes_) {
    if (view.version <= since) continue;
    nlohmann::json near = nlohmann::json::array();
    for (const auto& [other, count] : view.shared) near.push_back(other);
    keyframes.push_back({{"id", id},
                         {"map", view.map},
                         {"frame", view.frame},
                         {"time", view.time},
                         {"pose", pose_json(view.world_from_camera)},
                         {"parent", view.parent},
                         {"near", near}});
  }
  nlohmann::json& gone = head["gone_keyframes"] = nlohmann::json::array();
  std::vector<std::int32_t> ids, maps, gone_landmarks;
  std::vector<float> positions;
  if (!reset) {
    for (const Gone& g : gone_keyframes_) {
      if (g.version > since) gone.push_back(g.id);
    }
    for (const Gone& g : gone_landmarks_) {
      if (g.version > since) gone_landmarks.push_back(g.id);
    }
  }
  if (since != version_) {
    for (const auto& [id, point] : landmarks_) {
      if (point.version <= since) continue;
      ids.push_back(id);
      maps.push_back(map_of(id, point));
      positions.insert(positions.end(), point.position, point.position + 3);
    }
  }
  container.add("landmark_ids", ids);
  container.add("landmark_maps", maps);
  container.add("landmark_positions", positions);
  container.add("gone_landmarks", gone_landmarks);
}

}  // namespace dkp_slam::viewer

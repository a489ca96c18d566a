#include "dkp_slam/map/map_parts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/map/find_id.h"

namespace dkp_slam {
namespace {

bool plausible(const Se3& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < 1e-6;
}

template <class Item>
bool ids_in_order(const std::vector<Item>& items, int ids) {
  int last = -1;
  for (const Item& item : items) {
    if (item.id <= last || item.id >= ids) return false;
    last = item.id;
  }
  return true;
}

/// Where in the ascending items the one with this id is; -1 where none has it.
template <class Item>
int index_of(const std::vector<Item>& ascending, int id) {
  const Item* const item = find_id(ascending, id);
  return item ? static_cast<int>(item - ascending.data()) : -1;
}

std::optional<std::string> problem_of(const FrameFeatures& features, int levels) {
  const std::size_t count = features.pixel.size();
  for (const std::size_t other : {features.depth.size(), features.level.size(),
                                  features.angle.size(), features.descriptor.size()}) {
    if (other != count) return "its features' lists differ in length";
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float depth = features.depth[i];
    if (!is_pixel(features.pixel[i])) return fmt::format("feature {} lies nowhere", i);
    if (!std::isfinite(depth) || depth < 0.0F || !std::isfinite(features.angle[i]))
      return fmt::format("feature {} has an impossible depth or angle", i);
    if (features.level[i] >= levels) return fmt::format("feature {} is on no level", i);
  }
  return std::nullopt;
}

/// True when some keyframe is its own ancestor.
bool has_cycle(const std::vector<Keyframe>& keyframes) {
  std::vector<int> parent;  // as indices
  for (const Keyframe& k : keyframes) parent.push_back(index_of(keyframes, k.parent));
  std::vector<int> visit(keyframes.size(), -1);  // the walk that came by first
  for (int start = 0; start < std::ssize(keyframes); ++start) {
    for (int k = start; k >= 0; k = parent[static_cast<std::size_t>(k)]) {
      int& seen = visit[static_cast<std::size_t>(k)];
      if (seen == start) return true;
      if (seen >= 0) break;
      seen = start;
    }
  }
  return false;
}

/// `last_seen_by`: per landmark of the list, the keyframe of the checked ones that saw it last.
std::optional<std::string> problem_of(const Keyframe& k, const MapParts& parts,
                                      std::vector<int>& last_seen_by) {
  if (k.map < 0 || k.map >= parts.maps) return fmt::format("it belongs to no map ({})", k.map);
  if (!std::isfinite(k.timestamp)) return "its time stamp is no number";
  if (!plausible(k.camera_from_world)) return "its pose is none";
  if (auto problem = problem_of(k.features, parts.levels)) return problem;
  if (static_cast<int>(k.landmarks.size()) != k.features.size())
    return "it has not as many landmark ids as features";
  for (const int l : k.landmarks) {
    if (l == -1) continue;
    const int index = index_of(parts.landmarks, l);
    if (index < 0) return fmt::format("it sees landmark {}, which is not there", l);
    int& seen_by = last_seen_by[static_cast<std::size_t>(index)];
    if (seen_by == k.id) return fmt::format("it sees landmark {} twice", l);
    seen_by = k.id;
  }
  return std::nullopt;
}

std::optional<std::string> problem_of(const Landmark& l, const MapParts& parts) {
  if (!l.position.allFinite()) return "its position is none";
  if (l.first_keyframe < 0 || l.first_keyframe >= parts.keyframe_ids) return "no keyframe made it";
  if (l.visible < 1 || l.found < 1 || !std::isfinite(l.dynamic_log_odds))
    return "its counts are impossible";
  return std::nullopt;
}

}  // namespace

bool is_pixel(const cv::Point2f& point) {
  constexpr float most = 1e6F;
  return std::abs(point.x) < most && std::abs(point.y) < most;
}

std::optional<std::string> problem_of_counts(int keyframe_ids, int landmark_ids, int maps,
                                             int current_map) {
  if (keyframe_ids < 0 || keyframe_ids > most_keyframe_ids || landmark_ids < 0 ||
      landmark_ids > most_landmark_ids)
    return "no sensible number of keyframes and landmarks";
  if (maps < 1 || maps > most_keyframe_ids || current_map < 0 || current_map >= maps)
    return "no sensible number of maps";
  return std::nullopt;
}

std::optional<std::string> MapParts::check() const {
  if (const auto reason = camera.check()) return "camera: " + *reason;
  if (levels < 1 || levels > 64 || !(level_scale > 1.0F && level_scale < 10.0F))
    return "no sensible pyramid of levels";
  if (auto problem = problem_of_counts(keyframe_ids, landmark_ids, maps, current_map))
    return problem;
  if (!ids_in_order(keyframes, keyframe_ids)) return "the keyframes' ids are out of range";
  if (!ids_in_order(landmarks, landmark_ids)) return "the landmarks' ids are out of range";

  std::vector<int> last_seen_by(landmarks.size(), -1);
  for (const Keyframe& k : keyframes) {
    if (const auto problem = problem_of(k, *this, last_seen_by))
      return fmt::format("keyframe {}: {}", k.id, *problem);
    if (k.parent != -1 && index_of(keyframes, k.parent) < 0)
      return fmt::format("keyframe {}: its parent {} is not there", k.id, k.parent);
  }
  if (has_cycle(keyframes)) return "a keyframe is its own ancestor";
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const int id = landmarks[i].id;
    if (const auto problem = problem_of(landmarks[i], *this))
      return fmt::format("landmark {}: {}", id, *problem);
    if (last_seen_by[i] < 0) return fmt::format("landmark {}: no keyframe sees it", id);
  }
  return std::nullopt;
}

MapParts with_new_landmark_ids(MapParts parts) {
  for (Keyframe& k : parts.keyframes) {
    for (int& l : k.landmarks) l = index_of(parts.landmarks, l);
  }
  for (std::size_t i = 0; i < parts.landmarks.size(); ++i) {
    parts.landmarks[i].id = static_cast<int>(i);
  }
  parts.landmark_ids = static_cast<int>(parts.landmarks.size());
  return parts;
}

MapParts merged(MapParts a, MapParts b) {
  a = with_new_landmark_ids(std::move(a));
  b = with_new_landmark_ids(std::move(b));
  for (Keyframe& k : b.keyframes) {
    k.id += a.keyframe_ids;
    k.map += a.maps;
    if (k.parent >= 0) k.parent += a.keyframe_ids;
    for (int& l : k.landmarks) {
      if (l >= 0) l += a.landmark_ids;
    }
    a.keyframes.push_back(std::move(k));
  }
  for (Landmark& l : b.landmarks) {
    l.id += a.landmark_ids;
    l.first_keyframe += a.keyframe_ids;
    a.landmarks.push_back(std::move(l));
  }
  a.current_map = a.maps + b.current_map;
  a.keyframe_ids += b.keyframe_ids;
  a.landmark_ids += b.landmark_ids;
  a.maps += b.maps;
  return a;
}

std::optional<std::string> difference_of(const Camera& a, const Camera& b) {
  const std::pair<const char*, std::pair<double, double>> values[] = {
      {"width", {a.width, b.width}},
      {"height", {a.height, b.height}},
      {"fx", {a.fx, b.fx}},
      {"fy", {a.fy, b.fy}},
      {"cx", {a.cx, b.cx}},
      {"cy", {a.cy, b.cy}},
      {"distortion k1", {a.distortion.k1, b.distortion.k1}},
      {"distortion k2", {a.distortion.k2, b.distortion.k2}},
      {"distortion p1", {a.distortion.p1, b.distortion.p1}},
      {"distortion p2", {a.distortion.p2, b.distortion.p2}},
      {"distortion k3", {a.distortion.k3, b.distortion.k3}},
      {"baseline", {a.baseline, b.baseline}},
      {"readout", {a.readout, b.readout}},
  };
  for (const auto& [name, value] : values) {
    if (value.first != value.second)
      return fmt::format("{} is {} there and {} here", name, value.first, value.second);
  }
  return std::nullopt;
}

}  // namespace dkp_slam

#include "apps/map_report.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "dkp_slam/map_file/landmark_cloud.h"
#include "dkp_slam/map_file/map_rows.h"

namespace dkp_slam::apps {

std::vector<MapSummary> summaries_of(const Map& map) {
  std::map<int, MapSummary> by_id;
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    const Keyframe& keyframe = map.keyframe(k);
    if (keyframe.removed) continue;
    const double time = keyframe.timestamp;
    const auto [at, added] =
        by_id.try_emplace(keyframe.map, MapSummary{keyframe.map, 0, 0, time, time});
    MapSummary& summary = at->second;
    ++summary.keyframes;
    summary.first_timestamp = std::min(summary.first_timestamp, time);
    summary.last_timestamp = std::max(summary.last_timestamp, time);
  }
  for (const int l : map.landmarks()) ++by_id[map_of_landmark(map, l)].landmarks;
  std::vector<MapSummary> all;
  for (const auto& [id, summary] : by_id) all.push_back(summary);
  return all;
}

std::string map_text(const StoredMap& stored) {
  const Map& map = stored.map;
  const Camera& camera = map.camera();
  const std::vector<MapSummary> maps = summaries_of(map);
  std::string text = fmt::format(
      "{}: {:.1f} MB, format {}, written by dkp-slam {}\n"
      "camera {}: {} x {} pixels, fx {} fy {} cx {} cy {}\n"
      "{} map{}, {} keyframes, {} landmarks\n",
      stored.file.string(), static_cast<double>(stored.bytes) / 1e6, +map_format_version,
      stored.program_version, camera.name.empty() ? "without a name" : camera.name, camera.width,
      camera.height, camera.fx, camera.fy, camera.cx, camera.cy, maps.size(),
      maps.size() == 1 ? "" : "s", map.live_keyframes(), map.live_landmarks());
  for (const MapSummary& m : maps) {
    text += fmt::format("  map {}: {} keyframes, {} landmarks, {:.3f} .. {:.3f} s ({:.1f} s)\n",
                        m.id, m.keyframes, m.landmarks, m.first_timestamp, m.last_timestamp,
                        m.last_timestamp - m.first_timestamp);
  }
  return text;
}

nlohmann::ordered_json map_json(const StoredMap& stored) {
  const Camera& camera = stored.map.camera();
  nlohmann::ordered_json json;
  json["file"] = stored.file.string();
  json["bytes"] = stored.bytes;
  json["format"] = map_format_version;
  json["program_version"] = stored.program_version;
  json["camera"] = {{"name", camera.name}, {"width", camera.width}, {"height", camera.height},
                    {"fx", camera.fx},     {"fy", camera.fy},       {"cx", camera.cx},
                    {"cy", camera.cy}};
  json["keyframes"] = stored.map.live_keyframes();
  json["landmarks"] = stored.map.live_landmarks();
  json["maps"] = nlohmann::ordered_json::array();
  for (const MapSummary& m : summaries_of(stored.map)) {
    json["maps"].push_back({{"id", m.id},
                            {"keyframes", m.keyframes},
                            {"landmarks", m.landmarks},
                            {"first_timestamp", m.first_timestamp},
                            {"last_timestamp", m.last_timestamp}});
  }
  return json;
}

Trajectory keyframes_of(const Map& map, int id) {
  Trajectory poses;
  for (const int k : map.keyframes_in(id)) {
    poses.push_back({map.keyframe(k).timestamp, map.keyframe(k).camera_from_world.inverse()});
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const auto& a, const auto& b) { return a.timestamp < b.timestamp; });
  return poses;
}

}  // namespace dkp_slam::apps

#include "apps/run_outputs.h"

#include <algorithm>
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

struct Column {
  const char* name;
  double FrameReport::* value;
};

constexpr Column columns[] = {
    {"decode", &FrameReport::decode_ms},         {"features", &FrameReport::feature_ms},
    {"detection", &FrameReport::detection_ms},   {"clustering", &FrameReport::clustering_ms},
    {"removal", &FrameReport::removal_ms},       {"tracking", &FrameReport::tracking_ms},
    {"frame", &FrameReport::frame_ms},
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::string timings_csv(const std::vector<FrameReport>& frames) {
  std::string out = "index,timestamp,localised,keyframe,features,removed,detections,compensated,landmarks";
  for (const Column& c : columns) out += fmt::format(",{}_ms", c.name);
  out += '\n';
  for (const FrameReport& f : frames) {
    out += fmt::format("{},{:.6f},{:d},{:d},{},{},{},{},{}", f.index, f.timestamp, f.localised,
                       f.keyframe, f.features, f.removed_features, f.detections, f.compensated,
                       f.tracked_landmarks);
    for (const Column& c : columns) out += fmt::format(",{:.3f}", f.*c.value);
    out += '\n';
  }
  return out;
}

nlohmann::ordered_json summary_json(const RunTotals& totals, const Map& map,
                                    const nlohmann::ordered_json& options) {
  nlohmann::ordered_json json;
  json["version"] = DKP_SLAM_VERSION;
  json["options"] = options;
  json["interrupted"] = totals.interrupted;
  long localised = 0, features = 0, removed = 0, detections = 0, compensated = 0;
  for (const FrameReport& f : totals.frames) {
    localised += f.localised;
    features += f.features;
    removed += f.removed_features;
    detections += f.detections;
    compensated += f.compensated;
  }
  const auto frames = static_cast<long>(totals.frames.size());
  json["frames"] = frames;
  json["localised_frames"] = localised;
  json["lost_frames"] = frames - localised;
  json["skipped_frames"] = totals.skipped_frames;
  json["dropped_frames"] = totals.dropped_frames;
  json["detections"] = detections;
  json["compensated_detections"] = compensated;
  json["detector_failures"] = totals.detector_failures;
  json["features"] = features;
  json["features_removed"] = removed;
  json["keyframes"] = map.live_keyframes();
  json["landmarks"] = map.live_landmarks();
  nlohmann::ordered_json medians;
  for (const Column& c : columns) {
    std::vector<double> values;
    for (const FrameReport& f : totals.frames) values.push_back(f.*c.value);
    medians[c.name] = std::round(1000.0 * median(values)) / 1000.0;
  }
  json["median_ms"] = medians;
  json["peak_memory_mb"] = std::round(10.0 * peak_memory_mb()) / 10.0;
  return json;
}

double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0.0;
}

}  // namespace dkp_slam::apps

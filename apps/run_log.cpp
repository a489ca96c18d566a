#include "apps/run_log.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/evaluation/statistics.h"

namespace dkp_slam::apps {
namespace {

struct Column {
  const char* name;
  double FrameResult::*value;
};

/// The last ones of a line.
constexpr std::array columns = {
    Column{"decode", &FrameResult::decode_ms},
    Column{"features", &FrameResult::feature_ms},
    Column{"detection", &FrameResult::detection_ms},
    Column{"clustering", &FrameResult::clustering_ms},
    Column{"removal", &FrameResult::removal_ms},
    Column{"tracking", &FrameResult::tracking_ms},
    Column{"frame", &FrameResult::frame_ms},
    Column{"latency", &FrameResult::latency_ms},
};

std::string header() {
  std::string line =
      "index,timestamp,localised,keyframe,features,removed,detections,compensated,landmarks,"
      "position_sigma_m,people_share,since_map_seen_s,map_keyframes,map_landmarks,memory_mb";
  for (const Column& c : columns) line += fmt::format(",{}_ms", c.name);
  return line + '\n';
}

std::string line_of(const FrameResult& f, double memory_mb) {
  std::string line = fmt::format("{},{:.6f},{:d},{:d},{},{},{},{},{},", f.index, f.timestamp,
                                 f.localised, f.keyframe, f.features, f.removed_features,
                                 f.detections, f.compensated, f.tracked_landmarks);
  // Infinite where nothing is known: "inf".
  line += fmt::format("{:.4f},{:.3f},{:.3f},{},{},{:.1f}", f.quality.position_sigma(),
                      f.quality.people_share, f.quality.since_map_seen, f.map_keyframes,
                      f.map_landmarks, memory_mb);
  for (const Column& c : columns) line += fmt::format(",{:.3f}", f.*c.value);
  return line + '\n';
}

}  // namespace

RunLog::RunLog(const std::filesystem::path& folder)
    : timings_(folder / "timings.csv"), detections_(folder / "detections.txt") {
  timings_.append(header());
  detections_.append(recorded_header());
}

void RunLog::add(const FrameResult& frame, double memory_mb) {
  timings_.append(line_of(frame, memory_mb));
}

void RunLog::add(double timestamp, const DetectionResult& answer) {
  // Without a detector nothing is ever answered, and there is nothing to tell.
  answered_ = answered_ || answer.answered;
  if (!answered_) return;
  detections_.append(answer.answered ? recorded_lines(timestamp, answer.detections)
                                     : recorded_gap(timestamp));
}

std::vector<StageMedian> RunLog::medians() {
  std::array<std::vector<double>, columns.size()> values;
  bool first = true;
  timings_.for_each_line([&](std::string_view line) {
    for (std::size_t i = columns.size(); i-- > 0 && !first;) {
      const std::size_t comma = line.rfind(',');
      double value = 0.0;
      std::from_chars(line.data() + comma + 1, line.data() + line.size(), value);
      const bool not_looked = columns[i].value == &FrameResult::detection_ms && value == 0.0;
      if (!not_looked) values[i].push_back(value);
      line = line.substr(0, comma);
    }
    first = false;
  });
  std::vector<StageMedian> all;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    all.push_back({columns[i].name, values[i].empty() ? 0.0 : median(values[i])});
  }
  return all;
}

void RunLog::save() {
  detections_.save();
  timings_.save();
}

}  // namespace dkp_slam::apps

#include "bench/results/figures.h"

#include <algorithm>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/statistics.h"

namespace dkp_slam::bench {
namespace {

const std::string time_suffix = "_ms";

bool is_mask_quantity(Quantity quantity) {
  return quantity == Quantity::mask_iou || quantity == Quantity::features_removed ||
         quantity == Quantity::features_kept;
}

std::optional<double> value_of(const MaskFigures& figures, Quantity quantity) {
  if (quantity == Quantity::mask_iou) return figures.iou;
  return quantity == Quantity::features_removed ? figures.removed : figures.kept;
}

/// What a run that replays detections says nothing about.
bool is_of_whole_process(Quantity quantity) {
  return quantity == Quantity::frame_ms || quantity == Quantity::processor_ms ||
         quantity == Quantity::wall_ms || quantity == Quantity::peak_memory;
}

std::optional<double> value_of(const RunFigures& run, Quantity quantity) {
  if (!run.whole && is_of_whole_process(quantity)) return std::nullopt;
  const double frames = static_cast<double>(std::max<std::size_t>(run.frames, 1));
  switch (quantity) {
    case Quantity::ate:
      return run.ate_rmse;
    case Quantity::ate_deviation:
      return run.ate_deviation;
    case Quantity::lost_frames:
      return static_cast<double>(run.lost_frames);
    case Quantity::rpe_second:
      return run.rpe_second;
    case Quantity::rpe_frame:
      return run.rpe_frame;
    case Quantity::rpe_degrees:
      return run.rpe_degrees;
    case Quantity::frame_ms: {
      const auto found = run.stage_ms.find("frame");
      return found == run.stage_ms.end() ? std::nullopt : std::optional(found->second);
    }
    case Quantity::without_detection_ms:
      return run.without_detection_ms;
    case Quantity::processor_ms:
      return 1000.0 * run.processor_s / frames;
    case Quantity::wall_ms:
      return 1000.0 * run.wall_s / frames;
    case Quantity::peak_memory:
      return run.peak_memory_mb;
    default:
      return std::nullopt;
  }
}

bool matches(const RunKey& key, const std::string& sequence, const std::string& mode) {
  return key.sequence == sequence && key.mode == mode;
}

}  // namespace

std::vector<double> values(const Results& results, const std::string& sequence,
                           const std::string& mode, Quantity quantity) {
  std::vector<double> out;
  const auto add = [&](const auto& figures) {
    if (!matches(figures.key, sequence, mode)) return;
    if (const auto value = value_of(figures, quantity)) out.push_back(*value);
  };
  if (is_mask_quantity(quantity)) {
    for (const MaskFigures& figures : results.masks) add(figures);
    return out;
  }
  for (const RunFigures& run : results.runs) {
    if (run.problem.empty()) add(run);
  }
  return out;
}

std::vector<double> stage_values(const Results& results, const std::string& sequence,
                                 const std::string& mode, const std::string& stage) {
  std::vector<double> out;
  for (const RunFigures& run : results.runs) {
    if (!run.problem.empty() || !run.whole || !matches(run.key, sequence, mode)) continue;
    const auto found = run.stage_ms.find(stage);
    if (found != run.stage_ms.end()) out.push_back(found->second);
  }
  return out;
}

std::optional<double> median_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return median(values);
}

void set_times(RunFigures& figures, const std::map<std::string, std::vector<double>>& timings) {
  figures.stage_ms.clear();
  for (const auto& [name, column] : timings) {
    if (!name.ends_with(time_suffix)) continue;
    figures.stage_ms[name.substr(0, name.size() - time_suffix.size())] = median(column);
  }
  // The stages that follow each other for every frame, the detector left out. The sum of medians
  // would not be the median of the sums.
  std::vector<double> sums;
  for (const char* stage : {"features_ms", "clustering_ms", "removal_ms", "tracking_ms"}) {
    const auto column = timings.find(stage);
    if (column == timings.end()) {
      throw Error(fmt::format("timings.csv: no column {}; is the program of this version?", stage));
    }
    sums.resize(column->second.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += column->second[i];
  }
  figures.without_detection_ms = median(sums);
}

}  // namespace dkp_slam::bench

#include "dkp_slam/evaluation/report/record_set.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/evaluation/measure/sequence_name.h"
#include "dkp_slam/evaluation/statistics.h"

namespace dkp_slam {
namespace {

template <class T>
void add_once(std::vector<T>& all, const T& one) {
  if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
}

/// Darker for the second detector of a mode, lighter for the third.
Colour shade(Colour colour, std::size_t step) {
  constexpr std::array<double, 3> factors = {1.0, 0.6, 1.5};
  const double factor = factors[step % factors.size()];
  const auto scaled = [&](int value) {
    const double light = factor > 1.0 ? 255.0 - (255.0 - value) / factor : value * factor;
    return std::clamp(static_cast<int>(light), 0, 255);
  };
  return {scaled(colour.red), scaled(colour.green), scaled(colour.blue)};
}

}  // namespace

BenchConfig config_of(const RunRecord& record) {
  return {record.mode, record.detector, record.model};
}

RecordSet::RecordSet(std::vector<RunRecord> records) : records_(std::move(records)) {
  for (const RunRecord& record : records_) {
    add_once(sequences_, record.sequence);
    add_once(configs_, config_of(record));
  }
  // By mode, then detector, whatever the first sequence was run with.
  const auto order = [](const BenchConfig& c) {
    const auto place = [](const std::vector<std::string>& all, const std::string& one) {
      return std::find(all.begin(), all.end(), one) - all.begin();
    };
    return std::tuple(place(bench_modes(), c.mode), place(bench_detectors(), c.detector), c.model);
  };
  std::sort(configs_.begin(), configs_.end(),
            [&](const BenchConfig& a, const BenchConfig& b) { return order(a) < order(b); });
}

std::vector<BenchConfig> RecordSet::best_configs() const {
  std::vector<BenchConfig> best;
  for (const BenchConfig& config : configs_) {
    if (config.mode == configs_.back().mode) best.push_back(config);
  }
  return best;
}

std::vector<const RunRecord*> RecordSet::runs(const std::string& sequence,
                                              const BenchConfig& config) const {
  std::vector<const RunRecord*> found;
  for (const RunRecord* run : runs(config)) {
    if (run->sequence == sequence) found.push_back(run);
  }
  return found;
}

std::vector<const RunRecord*> RecordSet::paper_runs(const std::string& name, bool synthetic,
                                                    const BenchConfig& config) const {
  std::vector<const RunRecord*> found;
  for (const RunRecord* run : runs(config)) {
    const auto paper = paper_sequence(run->sequence, run->scenario);
    if (paper && paper->name == name && paper->synthetic == synthetic) found.push_back(run);
  }
  return found;
}

std::vector<const RunRecord*> RecordSet::runs(const BenchConfig& config) const {
  std::vector<const RunRecord*> found;
  for (const RunRecord& run : records_) {
    if (run.problem.empty() && config_of(run) == config) found.push_back(&run);
  }
  return found;
}

std::string RecordSet::label(const BenchConfig& config) const {
  std::set<std::string> models;
  for (const BenchConfig& other : configs_) {
    if (!other.model.empty()) models.insert(other.model);
  }
  if (config.detector == "none") {
    const bool uses_one = mode_info(mode_named(config.mode)).detector;
    return uses_one ? config.mode + ", no detector" : config.mode;
  }
  const bool several = models.size() > 1 && !config.model.empty();
  return config.mode + ", " + config.detector + (several ? " " + config.model : "");
}

Colour RecordSet::colour(const BenchConfig& config) const {
  static const std::map<std::string, Colour> colours{
      {"off", {222, 92, 56}},  {"masks", {0, 150, 136}}, {"paper", {120, 120, 120}},
      {"d", {214, 158, 30}},   {"dk", {92, 156, 68}},    {"dkp", {136, 86, 190}},
      {"dkp+", {31, 110, 190}}};
  std::size_t step = 0;
  for (const BenchConfig& other : configs_) {
    if (other == config) break;
    if (other.mode == config.mode) ++step;
  }
  return shade(colours.at(config.mode), step);
}

const RunRecord* median_run(std::vector<const RunRecord*> runs) {
  if (runs.empty()) return nullptr;
  std::stable_sort(runs.begin(), runs.end(),
                   [](const RunRecord* a, const RunRecord* b) { return a->ate_m < b->ate_m; });
  return runs[(runs.size() - 1) / 2];
}

HtmlCell spread_cell(std::vector<double> values, int decimals) {
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::string least = fmt::format("{:.{}f}", *low, decimals);
  const std::string most = fmt::format("{:.{}f}", *high, decimals);
  return {fmt::format("{:.{}f}", median(values), decimals),
          least == most ? "" : least + "–" + most};
}

}  // namespace dkp_slam

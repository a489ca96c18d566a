#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/canvas.h"
#include "dkp_slam/evaluation/report/html.h"
#include "dkp_slam/evaluation/report/run_record.h"

namespace dkp_slam {

/// What was run, without the sequence: an ablation mode with a detector.
struct BenchConfig {
  std::string mode, detector, model;

  bool operator==(const BenchConfig&) const = default;
};

/// The records of a bench by what was run on what.
class RecordSet {
 public:
  /// `records` in the order in which they are to be reported, as from `latest_records`.
  explicit RecordSet(std::vector<RunRecord> records);

  const std::vector<RunRecord>& records() const { return records_; }
  const std::vector<std::string>& sequences() const { return sequences_; }
  const std::vector<BenchConfig>& configs() const { return configs_; }
  /// Those of the most complete mode that was run, one for each detector: what the program is
  /// judged by.
  std::vector<BenchConfig> best_configs() const;

  /// Good runs of a sequence.
  std::vector<const RunRecord*> runs(const std::string& sequence, const BenchConfig& config) const;
  /// Good runs of all sequences that are the paper's `name`, as recorded or as generated.
  std::vector<const RunRecord*> paper_runs(const std::string& name, bool synthetic,
                                           const BenchConfig& config) const;
  /// Good runs on everything.
  std::vector<const RunRecord*> runs(const BenchConfig& config) const;

  /// "dkp+, motion"; the model is named where there are several.
  std::string label(const BenchConfig& config) const;
  /// A colour of its own for each of the configurations.
  Colour colour(const BenchConfig& config) const;

 private:
  std::vector<RunRecord> records_;
  std::vector<std::string> sequences_;
  std::vector<BenchConfig> configs_;
};

BenchConfig config_of(const RunRecord& record);

/// The run whose ATE is the median; of an even number the better of the two in the middle. Null
/// where there is none.
const RunRecord* median_run(std::vector<const RunRecord*> runs);

/// A quantity of the runs that have it.
template <class Quantity>
std::vector<double> values_of(const std::vector<const RunRecord*>& runs, Quantity quantity) {
  std::vector<double> values;
  for (const RunRecord* run : runs) {
    if (const std::optional<double> value = quantity(*run)) values.push_back(*value);
  }
  return values;
}

/// The median with these decimals, and below it the smallest and the largest where there are
/// several; empty without a value.
HtmlCell spread_cell(std::vector<double> values, int decimals);

}  // namespace dkp_slam

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/relative_error.h"

namespace dkp_slam {

struct EvaluationOptions {
  AssociationOptions association;
  /// Drift per second, the benchmark's figure, and per frame, which some papers report instead.
  std::vector<RelativeErrorOptions> steps = {
      {.delta = 1.0, .unit = StepUnit::seconds},
      {.delta = 1.0, .unit = StepUnit::frames},
  };
};

/// Relative error over one step, or why there is none (a path shorter than the step, say).
struct StepResult {
  RelativeErrorOptions options;
  std::optional<RelativeError> error;
  std::string problem;  ///< set when `error` is not
};

/// All there is to say about one trajectory.
struct EvaluationReport {
  std::size_t truth_poses = 0;
  std::size_t estimate_poses = 0;
  AssociationOptions association;
  AbsoluteError absolute;
  std::vector<StepResult> steps;
};

/// Absolute error, and relative error over each step with the association's time offset. Throws
/// `Error` when the absolute error cannot be computed.
EvaluationReport evaluate(std::span<const StampedPose> truth, std::span<const StampedPose> estimate,
                          const EvaluationOptions& options = {});

/// A line of the report's table.
struct ReportRow {
  std::string name;  ///< "RPE 1 s"; empty: of the line above, in another unit
  std::string unit;  ///< "m" or "deg"
  ErrorStatistics statistics;
  std::string problem;  ///< why there are no figures
};

std::vector<ReportRow> report_rows(const EvaluationReport& report);

/// A table to read, metres and degrees, with a line break at the end.
std::string text_report(const EvaluationReport& report, const std::string& truth_name,
                        const std::string& estimate_name);

/// The same as a JSON object with every digit; keys end in their unit (_m, _deg, _s).
std::string json_report(const EvaluationReport& report, const std::string& truth_name,
                        const std::string& estimate_name);

}  // namespace dkp_slam

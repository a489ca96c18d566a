#include "dkp_slam/evaluation/report.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/version.h"

namespace dkp_slam {
namespace {

constexpr double degrees_per_radian = 180.0 / M_PI;

ErrorStatistics scaled(ErrorStatistics statistics, double factor) {
  for (double* value : {&statistics.rmse, &statistics.mean, &statistics.median,
                        &statistics.deviation, &statistics.min, &statistics.max}) {
    *value *= factor;
  }
  return statistics;
}

std::string step_name(const RelativeErrorOptions& step) {
  if (step.all_pairs) return "RPE all pairs";
  if (step.unit != StepUnit::frames) {
    return fmt::format("RPE {:g} {}", step.delta, short_name(step.unit));
  }
  return fmt::format("RPE {:g} {}", step.delta, step.delta == 1.0 ? "frame" : "frames");
}

nlohmann::ordered_json json_of(const ErrorStatistics& s) {
  return {{"rmse", s.rmse},           {"mean", s.mean}, {"median", s.median},
          {"deviation", s.deviation}, {"min", s.min},   {"max", s.max}};
}

nlohmann::ordered_json json_of(const Se3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

nlohmann::ordered_json json_of(const StepResult& step) {
  nlohmann::ordered_json json;
  if (!step.options.all_pairs) {
    json["delta"] = step.options.delta;
    json["unit"] = short_name(step.options.unit);
  }
  json["all_pairs"] = step.options.all_pairs;
  if (!step.error) {
    json["problem"] = step.problem;
    return json;
  }
  json["pairs"] = step.error->translation.count;
  json["translation_m"] = json_of(step.error->translation);
  json["rotation_deg"] = json_of(scaled(step.error->rotation, degrees_per_radian));
  return json;
}

}  // namespace

EvaluationReport evaluate(std::span<const StampedPose> truth, std::span<const StampedPose> estimate,
                          const EvaluationOptions& options) {
  EvaluationReport report;
  report.truth_poses = truth.size();
  report.estimate_poses = estimate.size();
  report.association = options.association;
  report.absolute = absolute_error(truth, estimate, options.association);
  for (RelativeErrorOptions step : options.steps) {
    step.offset = options.association.offset;
    StepResult result{.options = step, .error = std::nullopt, .problem = ""};
    try {
      result.error = relative_error(truth, estimate, step);
    } catch (const Error& error) {
      result.problem = error.what();
    }
    report.steps.push_back(std::move(result));
  }
  return report;
}

std::vector<ReportRow> report_rows(const EvaluationReport& report) {
  std::vector<ReportRow> rows{{"ATE", "m", report.absolute.statistics, ""}};
  for (const StepResult& step : report.steps) {
    if (!step.error) {
      rows.push_back({step_name(step.options), "", {}, step.problem});
      continue;
    }
    rows.push_back({step_name(step.options), "m", step.error->translation, ""});
    rows.push_back({"", "deg", scaled(step.error->rotation, degrees_per_radian), ""});
  }
  return rows;
}

std::string text_report(const EvaluationReport& report, const std::string& truth_name,
                        const std::string& estimate_name) {
  std::string text = fmt::format(
      "ground truth  {}: {} poses\ntrajectory    {}: {} poses, {} compared\n\n", truth_name,
      report.truth_poses, estimate_name, report.estimate_poses, report.absolute.statistics.count);
  fmt::format_to(std::back_inserter(text), "{:<18}{:>8}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "",
                 "pairs", "RMSE", "mean", "median", "S.D.", "min", "max");
  for (const ReportRow& row : report_rows(report)) {
    if (!row.problem.empty()) {
      text += fmt::format("{:<18}  {}\n", row.name, row.problem);
      continue;
    }
    const ErrorStatistics& s = row.statistics;
    text += fmt::format("{:<14}{:>4}{:>8}{:>11.6f}{:>11.6f}{:>11.6f}{:>11.6f}{:>11.6f}{:>11.6f}\n",
                        row.name, row.unit, s.count, s.rmse, s.mean, s.median, s.deviation, s.min,
                        s.max);
  }
  return text;
}

std::string json_report(const EvaluationReport& report, const std::string& truth_name,
                        const std::string& estimate_name) {
  const AbsoluteError& absolute = report.absolute;
  nlohmann::ordered_json json;
  json["version"] = DKP_SLAM_VERSION;
  json["ground_truth"] = {{"file", truth_name}, {"poses", report.truth_poses}};
  json["trajectory"] = {{"file", estimate_name}, {"poses", report.estimate_poses}};
  json["association"] = {{"max_difference_s", report.association.max_difference},
                         {"offset_s", report.association.offset}};
  json["ate"] = {{"pairs", absolute.statistics.count},
                 {"translation_m", json_of(absolute.statistics)},
                 {"truth_from_trajectory", json_of(absolute.truth_from_estimate)}};
  json["rpe"] = nlohmann::ordered_json::array();
  for (const StepResult& step : report.steps) json["rpe"].push_back(json_of(step));
  // A file name that is not UTF-8 must not cost the user the figures.
  return json_text(json) + "\n";
}

}  // namespace dkp_slam

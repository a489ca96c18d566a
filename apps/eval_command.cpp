#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/frame_rate_option.h"
#include "apps/print_text.h"
#include "apps/true_path.h"
#include "apps/whole_number.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/report.h"
#include "dkp_slam/evaluation/report/evaluation_page.h"
#include "dkp_slam/evaluation/trajectory_plot.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

const std::string standard_output = "-";

const std::map<std::string, StepUnit> step_units = {
    {"s", StepUnit::seconds},       {"seconds", StepUnit::seconds}, {"f", StepUnit::frames},
    {"frames", StepUnit::frames},   {"m", StepUnit::metres},        {"metres", StepUnit::metres},
    {"rad", StepUnit::radians},     {"radians", StepUnit::radians}, {"deg", StepUnit::degrees},
    {"degrees", StepUnit::degrees},
};

struct EvalArguments {
  std::string truth;
  std::string trajectory;
  double frame_rate = usual_frame_rate;  ///< Hz, of a folder without time stamps
  AssociationOptions association;
  RelativeErrorOptions step;
  std::string json;
  std::string plot;
  std::string html;
  bool own_step = false;  ///< the user chose the step of the relative error
};

/// Writes to a file, or to the standard output where the name is "-".
void write_output(const std::string& name, const std::string& content) {
  if (name != standard_output) {
    write_file_atomically(name, content);
  } else {
    print_text(content, "give a file name instead");
  }
}

std::string figure(const EvalArguments& arguments, const Trajectory& truth,
                   const Trajectory& estimate, const EvaluationReport& report) {
  const bool svg = fs::path(arguments.plot).extension() == ".svg";
  const std::unique_ptr<Canvas> canvas =
      svg ? svg_canvas(plot_width, plot_height) : png_canvas(plot_width, plot_height);
  const ErrorStatistics& ate = report.absolute.statistics;
  draw_trajectories(
      *canvas, truth, estimate, report.absolute, report.association,
      fmt::format("{}: ATE RMSE {:.4f} m, {} poses",
                  fs::path(arguments.trajectory).filename().string(), ate.rmse, ate.count));
  return canvas->encode();
}

Trajectory read_truth(const EvalArguments& arguments) {
  if (!fs::is_directory(arguments.truth)) return read_trajectory(arguments.truth);
  Trajectory path = true_path(arguments.truth, arguments.frame_rate);
  if (path.empty()) {
    throw Error(arguments.truth +
                ": this folder brings no true path: no groundtruth.txt, nor pose files of a layout "
                "that has them (docs/sources.md)");
  }
  return path;
}

void evaluate_files(const EvalArguments& arguments) {
  for (const std::string& output : {arguments.json, arguments.plot, arguments.html}) {
    if (!output.empty() && output != standard_output) check_writable(output);
  }
  const Trajectory truth = read_truth(arguments);
  const Trajectory estimate = read_trajectory(arguments.trajectory);
  EvaluationOptions options;
  options.association = arguments.association;
  if (arguments.own_step) options.steps = {arguments.step};
  for (RelativeErrorOptions& step : options.steps) {
    step.max_pairs = arguments.step.max_pairs;
    step.seed = arguments.step.seed;
  }
  const EvaluationReport report = evaluate(truth, estimate, options);
  if (arguments.own_step && !report.steps.front().error) throw Error(report.steps.front().problem);

  if (!arguments.json.empty()) {
    write_output(arguments.json, json_report(report, arguments.truth, arguments.trajectory));
  }
  if (!arguments.plot.empty()) {
    write_file_atomically(arguments.plot, figure(arguments, truth, estimate, report));
  }
  if (!arguments.html.empty()) {
    write_file_atomically(arguments.html, evaluation_page(truth, estimate, report, arguments.truth,
                                                          arguments.trajectory));
  }
  if (arguments.json != standard_output) {
    write_output(standard_output, text_report(report, arguments.truth, arguments.trajectory));
  }
}

/// Misuse of the command line: a plot of a kind we do not draw.
std::string check_plot_name(const std::string& name) {
  const fs::path extension = fs::path(name).extension();
  return extension == ".svg" || extension == ".png" ? "" : "must end in .svg or .png: " + name;
}

/// Misuse of the command line: a number that is not finite.
std::string check_finite(const std::string& text) {
  double value = 0.0;
  const bool finite = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
  return finite ? "" : "not a number: " + text;
}

/// Misuse of the command line: a number that is not finite or not above 0.
std::string check_positive(const std::string& text) {
  double value = 0.0;
  const bool positive =
      CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0;
  return positive ? "" : "not a number above 0: " + text;
}

/// Turns a unit's name into its number, by which CLI11 reads an enumeration.
std::string transform_unit(std::string& text) {
  for (const auto& [name, unit] : step_units) {
    if (text != name) continue;
    text = std::to_string(static_cast<int>(unit));
    return "";
  }
  return "must be s, f, m, rad or deg: " + text;
}

}  // namespace

void add_eval_command(CLI::App& program) {
  auto* command = program.add_subcommand(
      "eval",
      "Compare a trajectory with the ground truth: ATE and RPE as the TUM RGB-D benchmark "
      "defines them");
  const auto arguments = std::make_shared<EvalArguments>();
  command
      ->add_option("groundtruth", arguments->truth,
                   "True trajectory, TUM format, or the folder of the sequence that brings it")
      ->required();
  add_frame_rate_option(*command, arguments->frame_rate);
  command->add_option("trajectory", arguments->trajectory, "Trajectory to judge, TUM format")
      ->required();
  command
      ->add_option("--max-difference", arguments->association.max_difference,
                   "Poses this far apart or further do not match [s]")
      ->check(check_positive)
      ->capture_default_str();
  command
      ->add_option("--offset", arguments->association.offset,
                   "Added to the time stamps of the trajectory [s]")
      ->check(check_finite)
      ->capture_default_str();
  auto* delta = command
                    ->add_option("--rpe-delta", arguments->step.delta,
                                 "Step of the relative error (default: 1 s, and 1 frame)")
                    ->check(check_positive);
  auto* unit = command
                   ->add_option("--rpe-unit", arguments->step.unit,
                                "Unit of the step: s, f (frames), m, rad or deg")
                   ->transform(CLI::Validator(transform_unit, "UNIT"));
  auto* all_pairs =
      command
          ->add_flag("--rpe-all-pairs", arguments->step.all_pairs,
                     "Relative error between all pairs of poses instead of over a step")
          ->excludes(delta)
          ->excludes(unit);
  command
      ->add_option("--rpe-max-pairs", arguments->step.max_pairs,
                   "Sample this many pairs where there are more; 0: take all")
      ->check(check_whole_number)
      ->capture_default_str();
  command->add_option("--seed", arguments->step.seed, "Of that sampling")
      ->check(check_whole_number)
      ->capture_default_str();
  command->add_option("--json", arguments->json,
                      "Write the figures as JSON to this file; -: to the standard output, instead "
                      "of the table");
  command
      ->add_option("--plot", arguments->plot,
                   "Draw both paths, their differences and the error over time: .svg or .png")
      ->check(check_plot_name);
  command->add_option("--html", arguments->html,
                      "Write a page to look into: figures, paths, error and drift over time");
  command->callback([arguments, delta, unit, all_pairs] {
    arguments->own_step = delta->count() + unit->count() + all_pairs->count() > 0;
    evaluate_files(*arguments);
  });
}

}  // namespace dkp_slam::apps

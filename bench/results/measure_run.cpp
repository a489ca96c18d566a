#include <algorithm>
#include <cstddef>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/results/measure.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/measure/child_process.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"
#include "dkp_slam/evaluation/relative_error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/json_integer.h"
#include "dkp_slam/json_text.h"

namespace dkp_slam::bench {
namespace {

namespace fs = std::filesystem;

// Written last: a run without it was cut off.
const char* const record_name = "process.json";
constexpr std::uint64_t first_seed = 1;

std::vector<std::string> command_of(const MeasureOptions& options, const RunKey& key) {
  std::vector<std::string> command = {options.program.string(),
                                      "run",
                                      (options.data / key.sequence).string(),
                                      "--camera",
                                      camera_of(options, key.sequence).string(),
                                      "--mode",
                                      key.mode,
                                      "--seed",
                                      std::to_string(key.seed),
                                      "--out",
                                      (run_folder(options, key) / "out").string()};
  if (key.mode == mode_info(DynamicsMode::masks).name) {
    command.insert(command.end(), {"--masks", (options.data / key.sequence / "mask").string()});
  }
  if (!mode_info(mode_named(key.mode)).detector) return command;
  command.insert(command.end(), {"--detector", options.model.empty() ? "motion" : "yolox"});
  if (!options.model.empty()) command.insert(command.end(), {"--model", options.model.string()});
  return command;
}

/// The run whose detections a run replays: a detector answers every seed alike.
RunKey first_of(const RunKey& key) { return {key.sequence, key.mode, first_seed}; }

/// The run with the detections of `detected`, one frame at a time: its times are those of tracking
/// alone, as those of systems that read, detect and track in turn.
std::vector<std::string> replay_of(const MeasureOptions& options, const RunKey& key,
                                   const RunKey& detected) {
  const bool detects = mode_info(mode_named(key.mode)).detector;
  RunKey plain = key;
  if (detects) plain.mode = "off";  // no detector
  std::vector<std::string> command = command_of(options, plain);
  const fs::path folder = run_folder(options, key);
  *(std::find(command.begin(), command.end(), "--mode") + 1) = key.mode;
  *(std::find(command.begin(), command.end(), "--out") + 1) = (folder / "replay").string();
  command.emplace_back("--one-at-a-time");
  if (detects) {
    command.insert(
        command.end(),
        {"--detections", (run_folder(options, detected) / "out" / "detections.txt").string()});
  }
  return command;
}

std::map<std::string, std::vector<double>> read_times(const fs::path& folder) {
  return read_timings(text_of(folder / "timings.csv"));
}

nlohmann::json read_json(const fs::path& path) {
  std::ifstream in(path);
  nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  if (json.is_discarded()) throw Error(path.string() + ": is missing or no JSON; run it again");
  return json;
}

std::optional<RelativeError> step_error(const Trajectory& truth, const Trajectory& estimate,
                                        StepUnit unit) {
  try {
    return relative_error(truth, estimate, {.delta = 1.0, .unit = unit});
  } catch (const Error&) {
    return std::nullopt;  // the path is shorter than the step, or mostly without truth
  }
}

void set_errors(RunFigures& figures, const Trajectory& truth, const Trajectory& estimate) {
  const AbsoluteError ate = absolute_error(truth, estimate);
  figures.ate_rmse = ate.statistics.rmse;
  figures.ate_deviation = ate.statistics.deviation;
  if (const auto second = step_error(truth, estimate, StepUnit::seconds)) {
    figures.rpe_second = second->translation.rmse;
    figures.rpe_degrees = second->rotation.rmse * 180.0 / std::numbers::pi;
  }
  if (const auto frame = step_error(truth, estimate, StepUnit::frames)) {
    figures.rpe_frame = frame->translation.rmse;
  }
}

}  // namespace

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw Error(path.string() + ": cannot read");
  return text.str();
}

fs::path camera_of(const MeasureOptions& options, const std::string& sequence) {
  if (const auto given = options.cameras.find(sequence); given != options.cameras.end()) {
    return options.config / given->second;
  }
  const fs::path own = options.data / sequence / "camera.yaml";
  return fs::exists(own) ? own : options.config / camera_file(sequence);
}

fs::path run_folder(const MeasureOptions& options, const RunKey& key) {
  return options.runs / key.sequence / key.mode / fmt::format("seed{}", key.seed);
}

bool is_finished(const MeasureOptions& options, const RunKey& key) {
  const fs::path record = run_folder(options, key) / record_name;
  if (!fs::exists(record)) return false;
  const nlohmann::json json = read_json(record);
  return json.value("command", std::vector<std::string>()) == command_of(options, key) &&
         json.value("program", std::string()) == fingerprint(options.program);
}

bool measure_run(const MeasureOptions& options, const RunKey& key,
                 const std::function<bool()>& stop) {
  const fs::path folder = run_folder(options, key);
  fs::remove(folder / record_name);
  fs::remove_all(folder / "out");
  fs::remove_all(folder / "replay");
  fs::create_directories(folder);
  const bool whole = key.seed == first_seed || !is_finished(options, first_of(key)) ||
                     !read_run(options, first_of(key)).problem.empty();
  ProcessResult result;
  if (whole) result = run_process(command_of(options, key), folder / "log.txt", stop);
  if (!stop() && result.exit_code == 0) {
    const ProcessResult replay = run_process(replay_of(options, key, whole ? key : first_of(key)),
                                             folder / "replay_log.txt", stop);
    if (!whole) result = replay;
  }
  if (stop()) return false;
  const nlohmann::ordered_json record = {{"command", command_of(options, key)},
                                         {"whole", whole},
                                         {"program", fingerprint(options.program)},
                                         {"exit_code", result.exit_code},
                                         {"wall_s", result.wall_s},
                                         {"processor_s", result.processor_s},
                                         {"others_share", result.others_share}};
  write_file_atomically(folder / record_name, json_text(record) + "\n");
  return true;
}

RunFigures read_run(const MeasureOptions& options, const RunKey& key) {
  const fs::path folder = run_folder(options, key);
  RunFigures figures;
  figures.key = key;
  try {
    const nlohmann::json process = read_json(folder / record_name);
    figures.wall_s = process.at("wall_s");
    figures.processor_s = process.at("processor_s");
    figures.others_share = process.at("others_share");
    figures.whole = process.at("whole");
    const fs::path out = folder / (figures.whole ? "out" : "replay");
    if (const int code = integer_at<int>(process, "exit_code"); code != 0) {
      const char* const log = figures.whole ? "log.txt" : "replay_log.txt";
      throw Error(fmt::format("exit code {}: {}", code, last_line(folder / log)));
    }
    const nlohmann::json summary = read_json(out / "summary.json");
    figures.peak_memory_mb = summary.at("peak_memory_mb");
    // Frames whose images could not be read are lost to the user too.
    figures.frames =
        integer_at<std::size_t>(summary, "frames") +
        (summary.contains("skipped_frames") ? integer_at<std::size_t>(summary, "skipped_frames")
                                            : 0);
    set_times(figures, read_times(folder / "replay"));
    const double without_detection = figures.without_detection_ms;
    set_times(figures, read_times(out));
    figures.without_detection_ms = without_detection;
    const Trajectory estimate = read_trajectory(out / "trajectory.txt");
    // What lets the other seeds replay.
    if (text_of(out / "trajectory.txt") != text_of(folder / "replay" / "trajectory.txt")) {
      throw Error(folder.string() + ": the replay of its detections took another path");
    }
    // Counted in what a user gets, not taken from the program's own word.
    figures.lost_frames = figures.frames - std::min(figures.frames, estimate.size());
    set_errors(figures, read_trajectory(options.data / key.sequence / "groundtruth.txt"), estimate);
  } catch (const std::exception& error) {
    figures.problem = error.what();
  }
  return figures;
}

}  // namespace dkp_slam::bench

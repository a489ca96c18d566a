#include "apps/bench/execute.h"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <exception>
#include <mutex>
#include <numbers>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "apps/bench/output.h"
#include "apps/run_summary.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/measure/child_process.h"
#include "dkp_slam/evaluation/relative_error.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

// Exit codes from here on are signals' (128 + number), Ctrl-C's own included.
constexpr int first_signal_code = 128;

std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

std::vector<std::string> command_of(const BenchSetup& setup, const BenchJob& job,
                                    const fs::path& out) {
  std::vector<std::string> command = {setup.program.string(),
                                      "run",
                                      job.sequence.folder.string(),
                                      "--camera",
                                      job.sequence.camera.string(),
                                      "--mode",
                                      job.mode,
                                      "--seed",
                                      std::to_string(job.seed),
                                      "--out",
                                      out.string()};
  const BenchDetector& detector = job.detector;
  if (job.mode == mode_info(DynamicsMode::masks).name) {
    command.insert(command.end(), {"--masks", (job.sequence.folder / "mask").string()});
  } else if (detector.name == "boxes") {
    command.insert(command.end(),
                   {"--detections", (job.sequence.folder / "detections.txt").string()});
  } else {
    command.insert(command.end(), {"--detector", detector.name});
  }
  if (!detector.model.empty()) command.insert(command.end(), {"--model", detector.model.string()});
  command.insert(command.end(), job.config.begin(), job.config.end());
  return command;
}

/// The program's own word on why it failed, without its name in front and the folder behind, which
/// nobody will find later.
std::string failure_reason(const fs::path& log, const fs::path& out) {
  constexpr std::string_view name = "dkp-slam: ";
  const std::string folder = fmt::format(" ({} holds what there is)", out.string());
  std::string last = last_line(log);
  if (last.starts_with(name)) last.erase(0, name.size());
  if (last.ends_with(folder)) last.resize(last.size() - folder.size());
  return last;
}

void set_step_errors(RunRecord& record, const Trajectory& truth, const Trajectory& estimate) {
  const auto step = [&](StepUnit unit, std::optional<double>& metres,
                        std::optional<double>& degrees) {
    try {
      const RelativeError error = relative_error(truth, estimate, {.delta = 1.0, .unit = unit});
      metres = error.translation.rmse;
      degrees = error.rotation.rmse * 180.0 / std::numbers::pi;
    } catch (const Error&) {
      // The path is shorter than the step, or mostly without truth: there is no such figure.
    }
  };
  step(StepUnit::seconds, record.rpe_s_m, record.rpe_s_deg);
  step(StepUnit::frames, record.rpe_frame_m, record.rpe_frame_deg);
}

/// Figures from what the run left in its folder.
void read_output(const BenchJob& job, const fs::path& out, RunRecord& record) {
  const RunSummary summary = read_run_summary(out);
  // Frames whose images could not be read are lost to the user too.
  record.frames = summary.frames + summary.skipped_frames;
  record.features = summary.features;
  record.removed = summary.features_removed;
  record.keyframes = summary.keyframes;
  record.landmarks = summary.landmarks;
  record.loops_closed = summary.loops_closed;
  record.maps_joined = summary.maps_joined;
  record.maps = summary.maps;
  record.peak_memory_mb = summary.peak_memory_mb;
  record.stage_ms = summary.median_ms;
  const Trajectory truth = read_trajectory(job.sequence.folder / "groundtruth.txt");
  const Trajectory estimate = read_trajectory(out / "trajectory.txt");
  record.lost = record.frames - std::min(record.frames, estimate.size());
  const AbsoluteError error = absolute_error(truth, estimate);
  record.ate_m = error.statistics.rmse;
  record.ate_deviation_m = error.statistics.deviation;
  set_step_errors(record, truth, estimate);
}

/// The folder of a run with nothing in it. What an earlier, killed bench left running writes into a
/// folder of its own (`attempt`), which is gone by then.
void clear_folder(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  if (!error) fs::create_directories(folder, error);
  if (error) {
    throw Error(fmt::format("{}: {}; choose another --out", folder.string(), error.message()));
  }
}

/// The files that the report draws from, to where it looks for them. Only these are kept.
void keep_files(const BenchSetup& setup, const BenchJob& job, const fs::path& attempt,
                const fs::path& folder) {
  for (const char* name : {"trajectory.txt", "timings.csv", "summary.json"}) {
    if (fs::exists(attempt / name)) fs::rename(attempt / name, folder / name);
  }
  fs::remove_all(attempt);
  const fs::path truth = runs_folder(setup.out) / job.sequence.name / "groundtruth.txt";
  // Beside it first, then under its name: runs of the same sequence may end at the same time.
  const fs::path copy = folder / "groundtruth.txt";
  fs::copy_file(job.sequence.folder / "groundtruth.txt", copy,
                fs::copy_options::overwrite_existing);
  fs::rename(copy, truth);
}

}  // namespace

RunRecord record_of(const BenchSetup& setup, const BenchJob& job) {
  RunRecord record;
  record.sequence = job.sequence.name;
  record.scenario = job.sequence.scenario;
  record.mode = job.mode;
  record.detector = job.detector.name;
  record.model = job.detector.model.filename().string();
  record.seed = job.seed;
  record.jobs = setup.jobs;
  record.version = setup.version;
  record.program = setup.program_fingerprint;
  record.options = options_fingerprint(job);
  record.machine = setup.machine;
  return record;
}

bool is_done(const std::vector<RunRecord>& records, const RunRecord& wanted) {
  return std::any_of(records.begin(), records.end(), [&](const RunRecord& r) {
    return r.program == wanted.program && r.options == wanted.options &&
           run_name(r) == run_name(wanted) && r.exit_code < first_signal_code;
  });
}

std::optional<RunRecord> execute(const BenchSetup& setup, const BenchJob& job,
                                 const std::function<bool()>& stop) {
  RunRecord record = record_of(setup, job);
  const fs::path folder = runs_folder(setup.out) / run_name(record);
  const fs::path attempt = folder / fmt::format("attempt-{}", getpid());
  const fs::path log = folder / "log.txt";
  clear_folder(folder);
  const ProcessResult result = run_process(command_of(setup, job, attempt), log, stop);
  if (stop()) return std::nullopt;
  record.date = now();
  record.exit_code = result.exit_code;
  record.total_s = result.wall_s;
  record.processor_s = result.processor_s;
  record.others_share = result.others_share;
  try {
    if (result.exit_code != 0) {
      throw Error(
          result.exit_code > first_signal_code
              ? fmt::format("ended by signal {}", result.exit_code - first_signal_code)
              : fmt::format("exit code {}: {}", result.exit_code, failure_reason(log, attempt)));
    }
    read_output(job, attempt, record);
  } catch (const std::exception& error) {
    record.problem = error.what();
  }
  keep_files(setup, job, attempt, folder);
  return record;
}

void execute_all(const BenchSetup& setup, const std::vector<BenchJob>& jobs,
                 const std::function<bool()>& stop,
                 const std::function<void(const RunRecord&)>& finished) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  std::exception_ptr failure;
  std::mutex one_at_a_time;
  const auto work = [&] {
    const auto ended = [&] { return stop() || failed; };
    try {
      for (std::size_t i = next++; i < jobs.size() && !ended(); i = next++) {
        const std::optional<RunRecord> record = execute(setup, jobs[i], ended);
        if (!record) return;
        const std::lock_guard lock(one_at_a_time);
        append_record(results_file(setup.out), *record);
        finished(*record);
      }
    } catch (...) {
      const std::lock_guard lock(one_at_a_time);
      if (!failure) failure = std::current_exception();
      failed = true;
    }
  };
  std::vector<std::thread> threads;
  const std::size_t count = std::min(jobs.size(), static_cast<std::size_t>(setup.jobs));
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace dkp_slam::apps

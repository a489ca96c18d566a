#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "apps/bench/execute.h"
#include "apps/bench/merge.h"
#include "apps/bench/output.h"
#include "apps/bench/plan.h"
#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "apps/process.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"
#include "dkp_slam/evaluation/measure/machine.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

const std::string default_out = "out/bench";

struct BenchArguments {
  BenchPlanOptions plan;
  fs::path out = default_out;
  std::string shard = "1/1";
  // A run keeps about two cores busy: one prepares frames and detects, one tracks. More runs than
  // that would take each other's time, which is measured.
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 2);
};

BenchSetup setup_of(const BenchArguments& arguments) {
  const Machine machine = this_machine();
  BenchSetup setup;
  setup.program = this_program;
  setup.program_fingerprint = fingerprint(this_program);
  setup.version = machine.version;
  setup.machine = fmt::format("{}, {}", machine.processor, machine.memory);
  setup.out = arguments.out;
  setup.jobs = arguments.jobs;
  return setup;
}

std::string outcome(const RunRecord& r) {
  if (!r.problem.empty()) return "failed: " + r.problem;
  return fmt::format("ATE {:.4f} m, {} of {} frames lost, {:.1f} s", r.ate_m, r.lost, r.frames,
                     r.total_s);
}

/// The records of this program; those of others are no part of the report.
std::vector<RunRecord> own_records(const BenchSetup& setup) {
  std::vector<RunRecord> records = read_records(results_file(setup.out));
  std::erase_if(records,
                [&](const RunRecord& r) { return r.program != setup.program_fingerprint; });
  return latest_records(records);
}

/// Makes the runs and tells about them. Returns how many of them failed.
std::size_t make_runs(const BenchSetup& setup, const std::vector<BenchJob>& jobs,
                      std::size_t known) {
  Progress progress("bench", known + jobs.size());
  std::size_t done = known, failed = 0;
  progress.update(done, known > 0 ? "from before" : "");
  execute_all(setup, jobs, interrupted, [&](const RunRecord& record) {
    failed += record.problem.empty() ? 0 : 1;
    spdlog::info("{}: {}", run_name(record), outcome(record));
    progress.update(++done);
  });
  return failed;
}

void bench(const BenchArguments& arguments) {
  catch_interrupts();
  const std::vector<BenchJob> jobs =
      jobs_of_shard(plan_jobs(arguments.plan), parse_shard(arguments.shard));
  const BenchSetup setup = setup_of(arguments);
  prepare_output(arguments.out);
  const std::vector<RunRecord> before = own_records(setup);
  std::vector<BenchJob> left;
  for (const BenchJob& job : jobs) {
    if (!is_done(before, record_of(setup, job))) left.push_back(job);
  }
  const std::size_t known = jobs.size() - left.size();
  const std::size_t failed = make_runs(setup, left, known);
  std::vector<std::string> warnings;
  if (interrupted()) warnings.emplace_back("Interrupted: only what was measured until then.");
  if (const std::size_t programs = programs_of(read_records(results_file(arguments.out))).size();
      programs > 1) {
    warnings.push_back(fmt::format(
        "{} holds results of {} builds of the program. Here stand those of the one that wrote this "
        "report.",
        results_file(arguments.out).filename().string(), programs));
  }
  const std::vector<RunRecord> records = own_records(setup);
  write_bench_report(arguments.out, records, warnings);
  fmt::print("{} asked for, {} known from before; {} holds {}\nreport: {}\n",
             count_of(jobs.size(), "run"), known, results_file(arguments.out).string(),
             count_of(records.size(), "result"), report_file(arguments.out).string());
  std::fflush(stdout);
  if (interrupted()) {
    throw Error("interrupted; the same command goes on where this one was");
  }
  if (failed > 0) {
    throw Error(fmt::format("{} failed; {} says why", count_of(failed, "run"),
                            report_file(arguments.out).string()));
  }
}

std::string check_shard(const std::string& text) {
  try {
    parse_shard(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

void add_merge_command(CLI::App& bench_command) {
  const auto options = std::make_shared<BenchMergeOptions>();
  CLI::App* command = bench_command.add_subcommand(
      "merge", "Brings the results of several benches together, the shards of one for instance.");
  command->add_option("OUT", options->folders, "Output folders of bench")->required();
  command->add_option("--out", options->out, "Folder for all; results already there are kept")
      ->required();
  command->add_flag("--mixed", options->mixed,
                    "Take results of different builds of the program together");
  command->callback([options] {
    const std::size_t count = merge_benches(*options);
    fmt::print("{} in {}\nreport: {}\n", count_of(count, "result"),
               results_file(options->out).string(), report_file(options->out).string());
  });
}

void add_plan_options(CLI::App& command, BenchPlanOptions& plan) {
  command.add_option("DIR", plan.folders, "Folders in TUM RGB-D format, with groundtruth.txt");
  command.add_option("--modes", plan.modes, "Ablation modes, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(bench_modes()))
      ->capture_default_str();
  command
      .add_option(
          "--detector", plan.detectors,
          "What finds objects, separated by commas: auto (YOLOX when there is a model, else "
          "motion), yolox, motion, boxes (DIR/detections.txt) or none; each of them with "
          "each mode but off and masks (DIR/mask), which use none")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"auto", "yolox", "motion", "boxes", "none"}))
      ->capture_default_str();
  command.add_option("--model", plan.model,
                     "YOLOX model (.onnx); else DKP_SLAM_MODEL, models/, ~/.cache/dkp-slam");
  command.add_option("--camera", plan.camera,
                     fmt::format("Camera of all sequences: a file, or one of {}; else "
                                 "DIR/camera.yaml, else by the folder's name",
                                 camera_names));
  add_config_options(command, plan.config);
  command.add_option("--repeat", plan.repeat, "Runs of each, with seeds 1, 2, ...")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace

void add_bench_command(CLI::App& program) {
  const auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command = program.add_subcommand(
      "bench",
      "Runs sequences in all modes, several times, and writes one report: OUT/report.html, with "
      "the figures as JSON lines in OUT/results.jsonl. Runs that OUT holds already, made by this "
      "program with the same options, are not made again.");
  add_plan_options(*command, arguments->plan);
  command->add_option("--out", arguments->out, "Folder for the results; made where missing")
      ->capture_default_str();
  command
      ->add_option("--jobs", arguments->jobs,
                   "Runs at the same time; default: half the cores, as a run keeps two busy. Times "
                   "to quote need 1")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command
      ->add_option(
          "--shard", arguments->shard,
          "Only part I of N of the runs (1/4 to 4/4), to spread a bench over machines; see "
          "bench merge")
      ->check(CLI::Validator(check_shard, "I/N"))
      ->capture_default_str();
  add_merge_command(*command);
  command->callback([command, arguments] {
    if (command->got_subcommand("merge")) return;
    if (arguments->plan.folders.empty()) throw CLI::RequiredError("DIR");
    bench(*arguments);
  });
}

}  // namespace dkp_slam::apps

// One command that measures everything the project promises and prints it as a page of Markdown.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include "apps/progress.h"
#include "bench/results/figures.h"
#include "bench/results/measure.h"
#include "bench/results/report.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/machine.h"
#include "dkp_slam/evaluation/report/run_record.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::bench {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string data, model, out, also, resume, program, config = DKP_SLAM_CONFIG_DIR;
  int repeat = 3;
  std::vector<std::string> sequences{"fr1_xyz",
                                     "fr3_walking_halfsphere_50",
                                     "composite_xyz_walking",
                                     "composite_xyz_sitting",
                                     "composite_xyz_three",
                                     "fr1_rpy",
                                     "composite_rpy_walking",
                                     "composite_rpy_sitting"};
  // Cuts of the benchmark's sequences under short names, which do not tell their camera.
  std::vector<std::string> cameras{"fr1_xyz=tum_fr1.yaml",
                                   "fr3_walking_halfsphere_50=tum_fr3.yaml",
                                   "composite_xyz_walking=tum_fr1.yaml",
                                   "composite_xyz_sitting=tum_fr1.yaml",
                                   "composite_xyz_three=tum_fr1.yaml",
                                   "fr1_rpy=tum_fr1.yaml",
                                   "composite_rpy_walking=tum_fr1.yaml",
                                   "composite_rpy_sitting=tum_fr1.yaml"};
  std::vector<std::string> modes = bench_modes();
  std::vector<std::string> command;
};

// The mode whose masks and features the goals are about.
const std::string scored_mode = "dkp+";

std::uint64_t seed_of(int repetition) { return static_cast<std::uint64_t>(repetition); }

MeasureOptions measure_options(const Arguments& arguments) {
  MeasureOptions options;
  options.data = arguments.data;
  options.config = arguments.config;
  for (const std::string& given : arguments.cameras) {
    const std::size_t equals = given.find('=');
    if (equals == std::string::npos) throw Error(given + ": no SEQUENCE=FILE; see --cameras");
    options.cameras[given.substr(0, equals)] = given.substr(equals + 1);
  }
  options.program = arguments.program;
  if (arguments.program.empty()) {
    options.program = fs::read_symlink("/proc/self/exe").parent_path() / "dkp-slam";
  }
  if (const auto model = find_model(arguments.model)) options.model = fs::absolute(*model);
  options.runs = arguments.resume.empty()
                     ? fs::temp_directory_path() / fmt::format("dkp-slam-results-{}", getpid())
                     : fs::path(arguments.resume);
  return options;
}

/// Finds out before the first run what would stop a later one.
void check(const Arguments& arguments, const MeasureOptions& options) {
  if (!fs::exists(options.program)) {
    throw Error(options.program.string() +
                ": no such program; build it, or name it with --program");
  }
  for (const std::string& sequence : arguments.sequences) {
    const fs::path camera = camera_of(options, sequence);
    if (!fs::exists(camera)) throw Error(camera.string() + ": no such camera file; see --config");
    const fs::path truth = options.data / sequence / "groundtruth.txt";
    if (!fs::exists(truth)) {
      throw Error(truth.string() + ": is missing; see --data, or leave it out of --sequences");
    }
  }
  if (!arguments.out.empty()) check_writable(arguments.out);
  if (!arguments.also.empty() && !fs::is_regular_file(arguments.also)) {
    throw Error(arguments.also + ": no such file; make it with bench/back_end.py --out");
  }
  std::error_code problem;
  fs::create_directories(options.runs, problem);
  if (problem) throw Error(options.runs.string() + ": " + problem.message() + "; see --resume");
}

std::string outcome(const RunFigures& run) {
  if (!run.problem.empty()) return "failed: " + run.problem;
  return fmt::format("ATE {:.4f} m, {} of {} frames lost, {:.1f} s", run.ate_rmse, run.lost_frames,
                     run.frames, run.wall_s);
}

/// One run and its figures; false when interrupted.
bool add_run(const MeasureOptions& options, const RunKey& key, const std::string& label,
             Results& results) {
  const bool known = is_finished(options, key);
  if (!known && !measure_run(options, key, apps::interrupted)) return false;
  results.runs.push_back(read_run(options, key));
  fmt::print(stderr, "{}: {}{}\n", label, outcome(results.runs.back()),
             known ? " (measured before)" : "");
  return true;
}

/// The masks of one run; false when interrupted.
bool add_masks(const MeasureOptions& options, const RunKey& key, const std::string& label,
               Results& results) {
  std::optional<MaskFigures> masks = read_masks(options, key);
  if (!masks) {
    apps::Progress progress(label, std::nullopt);
    masks = measure_masks(options, key, apps::interrupted,
                          [&](std::size_t frames) { progress.update(frames, "masks"); });
  }
  if (!masks) return false;
  const auto share = [](const std::optional<double>& v) { return 100.0 * v.value_or(0.0); };
  fmt::print(stderr, "{}: IoU {:.1f} %, removed {:.1f} %, kept {:.1f} %\n", label,
             share(masks->iou), share(masks->removed), share(masks->kept));
  results.masks.push_back(*masks);
  return true;
}

/// Mode masks is the control: it runs where the true masks are known.
bool can_run(const MeasureOptions& options, const std::string& sequence, const std::string& mode) {
  return mode != mode_info(DynamicsMode::masks).name || has_masks(options, sequence);
}

/// Everything, a repetition at a time, so that an interrupted measurement has seen all sequences.
bool measure_all(const Arguments& arguments, const MeasureOptions& options, Results& results) {
  std::size_t total = 0;
  for (const std::string& sequence : arguments.sequences) {
    for (const std::string& mode : arguments.modes) total += can_run(options, sequence, mode);
  }
  total *= static_cast<std::size_t>(arguments.repeat);
  std::size_t at = 0;
  for (int repetition = 1; repetition <= arguments.repeat; ++repetition) {
    for (const std::string& sequence : arguments.sequences) {
      for (const std::string& mode : arguments.modes) {
        if (!can_run(options, sequence, mode)) continue;
        const RunKey key{sequence, mode, seed_of(repetition)};
        const std::string name =
            fmt::format("[{}/{}] {} {} seed {}", ++at, total, sequence, mode, key.seed);
        if (!add_run(options, key, name, results)) return false;
        if (mode != scored_mode || !has_masks(options, sequence)) continue;
        if (!add_masks(options, key, name + ", masks", results)) return false;
      }
    }
  }
  return true;
}

ReportHeader header_of(const Arguments& arguments, const MeasureOptions& options) {
  ReportHeader header;
  header.date = today();
  header.machine = this_machine();
  header.command = command_line(arguments.command);
  header.detector = options.model.empty()
                        ? "the model-free motion detector (no YOLOX model was given)"
                        : "YOLOX, " + options.model.filename().string() + ", on the processor";
  header.sequences = arguments.sequences;
  header.modes = arguments.modes;
  for (int r = 1; r <= arguments.repeat; ++r) header.seeds.push_back(seed_of(r));
  return header;
}

int run(const Arguments& arguments) {
  const MeasureOptions options = measure_options(arguments);
  check(arguments, options);
  apps::catch_interrupts();
  // Before the runs: the day and the commit are those of what is measured.
  ReportHeader header = header_of(arguments, options);
  Results results;
  header.complete = measure_all(arguments, options, results);
  std::string page = report(header, results);
  if (!arguments.also.empty()) page += '\n' + text_of(arguments.also);
  fmt::print("{}", page);
  if (!arguments.out.empty()) write_file_atomically(arguments.out, page);
  if (!header.complete) {
    fmt::print(stderr, "interrupted; go on with --resume {}\n", options.runs.string());
    return EXIT_FAILURE;
  }
  if (arguments.resume.empty()) fs::remove_all(options.runs);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace dkp_slam::bench

int main(int argc, char** argv) {
  using namespace dkp_slam;
  CLI::App app("Measures dkp-slam on real sequences and prints the results as Markdown");
  bench::Arguments arguments;
  arguments.command.assign(argv, argv + argc);
  app.add_option("--data", arguments.data, "Folder that holds the sequence folders")
      ->envname("DKP_SLAM_DATA")
      ->required();
  app.add_option("--model", arguments.model, "YOLOX model; default: as dkp-slam run looks for it");
  app.add_option("--repeat", arguments.repeat, "Runs of each sequence and mode; seeds 1, 2, ...")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--sequences", arguments.sequences, "Sequences, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option(
         "--cameras", arguments.cameras,
         "SEQUENCE=FILE, separated by commas: camera file (in --config) of a sequence whose "
         "folder neither holds a camera.yaml nor has its benchmark's name")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--modes", arguments.modes, "Ablation modes, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench_modes()))
      ->capture_default_str();
  app.add_option("--out", arguments.out, "File for the page, which is printed in any case");
  app.add_option("--also", arguments.also,
                 "Markdown to put at the page's end, as bench/back_end.py makes");
  app.add_option("--resume", arguments.resume,
                 "Folder of the runs: kept, and runs that it holds already are not repeated");
  app.add_option("--program", arguments.program,
                 "The dkp-slam to measure; default: beside this one");
  app.add_option("--config", arguments.config, "Folder of the camera files")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  // The page goes to the standard output: nothing else may.
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_level(spdlog::level::warn);
  try {
    return bench::run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "dkp-slam-results: {}\n", error.what());
    return EXIT_FAILURE;
  }
}

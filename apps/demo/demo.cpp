#include "apps/demo/demo.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/process.h"
#include "apps/progress.h"
#include "apps/run_summary.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/child_process.h"
#include "dkp_slam/evaluation/measure/machine.h"
#include "dkp_slam/evaluation/measure/timings.h"
#include "dkp_slam/evaluation/relative_error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

const std::string scenario = "walking_xyz";
const std::string best_mode = "dkp+";
constexpr int sample_frames = 4;
constexpr int candidates_per_sample = 6;
constexpr auto look_interval = std::chrono::milliseconds(250);

/// How far a step is by its log: 30 for "run: 30 of 300, 512 landmarks".
std::optional<std::size_t> steps_done(const fs::path& log) {
  std::istringstream line(last_line(log));
  std::string name, word, of;
  while (line >> word) {
    if (!name.ends_with(":")) {
      name = word;
      continue;
    }
    std::size_t done = 0;
    return std::istringstream(word) >> done && line >> of && of == "of" ? std::optional(done)
                                                                        : std::nullopt;
  }
  return std::nullopt;
}

/// Address of the page that a step serves, once its log says so; else empty.
std::string page_of(const fs::path& log) {
  const std::string before = "view: ";
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(before)) return line.substr(before.size());
  }
  return "";
}

/// Port in "http://127.0.0.1:8000/"; 0 where there is none.
int port_of(const std::string& page) {
  const std::size_t colon = page.rfind(':');
  return colon == std::string::npos ? 0 : std::atoi(page.c_str() + colon + 1);
}

/// Runs one step and shows how far it is, and where its page is.
ProcessResult run_step(const std::string& title, std::vector<std::string> command,
                       const fs::path& log, std::size_t frames) {
  command.insert(command.begin(), this_program);
  bool page_told = std::find(command.begin(), command.end(), "--view") == command.end();
  Progress progress(title, frames);
  progress.update(0);
  auto looked = std::chrono::steady_clock::now();
  const ProcessResult result = run_process(command, log, [&] {
    const auto now = std::chrono::steady_clock::now();
    if (now - looked > look_interval) {
      looked = now;
      if (const auto done = steps_done(log)) progress.update(std::min(*done, frames));
      const std::string page = page_told ? "" : page_of(log);
      if (!page.empty()) {
        spdlog::info("view: {}", page);
        page_told = true;
      }
    }
    return interrupted();
  });
  if (interrupted()) throw Error("interrupted");
  if (result.exit_code == 0) progress.update(frames);
  return result;
}

void make_sequence(const DemoOptions& options, const fs::path& folder) {
  const fs::path log = options.out / "synth.log";
  const ProcessResult result =
      run_step("1/3 a room with people",
               {"synth", scenario, "--out", folder.string(), "--seed", std::to_string(options.seed),
                "--frames", std::to_string(options.frames)},
               log, options.frames);
  if (result.exit_code != 0) {
    throw Error(fmt::format("the sequence was not made: {} ({})", last_line(log), log.string()));
  }
}

/// What a run left in its folder.
void read_run(const fs::path& folder, const Trajectory& truth, DemoRun& run) {
  const RunSummary summary = read_run_summary(folder);
  run.frames = summary.frames;
  run.path.estimate = read_trajectory(folder / "trajectory.txt");
  run.lost = run.frames - std::min(run.frames, run.path.estimate.size());
  run.path.error = absolute_error(truth, run.path.estimate);
  run.removed_share = static_cast<double>(summary.features_removed) /
                      std::max(1.0, static_cast<double>(summary.features));
  run.frame_ms = summary.median_ms.at("frame");
  run.detector = summary.detector;
  std::ifstream csv(folder / "timings.csv");
  std::ostringstream text;
  text << csv.rdbuf();
  run.timings = read_timings(text.str());
  try {
    run.rpe_second_m = relative_error(truth, run.path.estimate).translation.rmse;
  } catch (const Error&) {
    // Shorter than a second.
  }
}

DemoRun make_run(const DemoOptions& options, const std::string& mode, const std::string& title,
                 const Trajectory& truth) {
  DemoRun run;
  run.mode = mode;
  run.path.name = "mode " + mode;
  run.path.colour = mode == "off" ? Colour{222, 92, 56} : Colour{31, 110, 190};
  const fs::path folder = options.out / mode, log = options.out / (mode + ".log");
  const fs::path sequence = options.out / "sequence";
  const std::size_t every =
      std::max<std::size_t>(1, options.frames / (sample_frames * candidates_per_sample));
  std::vector<std::string> command{"run",
                                   sequence.string(),
                                   "--camera",
                                   (sequence / "camera.yaml").string(),
                                   "--mode",
                                   mode,
                                   "--seed",
                                   std::to_string(options.seed),
                                   "--overlay",
                                   "--overlay-every",
                                   std::to_string(every),
                                   "--out",
                                   folder.string()};
  if (!options.model.empty() && mode != "off") {
    command.insert(command.end(), {"--detector", "yolox", "--model", options.model});
  }
  if (options.view) {
    command.insert(command.end(), {"--view", "--port", std::to_string(options.port)});
  }
  fs::remove(folder / "summary.json");  // an earlier demo's is not to be taken for this one's
  const ProcessResult result = run_step(title, command, log, options.frames);
  run.seconds = result.wall_s;
  run.overlay = folder / "overlay";
  try {
    // A run that lost its way for most of the time counts as failed, but has something to show.
    read_run(folder, truth, run);
  } catch (const std::exception&) {
    throw Error(fmt::format("mode {} left no path: {} ({})", mode, last_line(log), log.string()));
  }
  return run;
}

/// Index of a picture of the overlay: 30 for frame_000030.png.
int index_of(const fs::path& picture) {
  const std::string name = picture.stem().string();
  return std::stoi(name.substr(name.find('_') + 1));
}

/// Of each part of the sequence the frame with most features removed, as both runs saw it.
std::vector<DemoFrame> choose_frames(const DemoRun& off, const DemoRun& best) {
  const std::vector<double>& removed = best.timings.at("removed");
  std::vector<int> indices;
  for (const auto& picture : fs::directory_iterator(best.overlay)) {
    const int index = index_of(picture.path());
    const bool both = fs::exists(off.overlay / picture.path().filename());
    if (both && static_cast<std::size_t>(index) < removed.size()) indices.push_back(index);
  }
  std::sort(indices.begin(), indices.end());
  std::vector<DemoFrame> frames;
  ImageReader reader;
  for (std::size_t part = 0; part < sample_frames; ++part) {
    const auto first =
        indices.begin() + static_cast<std::ptrdiff_t>(part * indices.size() / sample_frames);
    const auto last =
        indices.begin() + static_cast<std::ptrdiff_t>((part + 1) * indices.size() / sample_frames);
    const auto most = std::max_element(first, last, [&](int a, int b) {
      return removed[static_cast<std::size_t>(a)] < removed[static_cast<std::size_t>(b)];
    });
    if (most == last) continue;
    const std::string name = fmt::format("frame_{:06}.png", *most);
    DemoFrame frame{*most, reader.read_colour(off.overlay / name).image,
                    reader.read_colour(best.overlay / name).image};
    if (!frame.off.empty() && !frame.best.empty()) frames.push_back(frame);
  }
  return frames;
}

/// File name of the weights that a run used; empty when it was another detector.
std::string model_of(const fs::path& folder) {
  return fs::path(read_run_summary(folder).input.model).filename();
}

}  // namespace

DemoResult make_demo(const DemoOptions& options) {
  DemoResult result;
  result.options = options;
  result.scenario = scenario;
  const Machine machine = this_machine();
  result.version = machine.version;
  result.machine = machine.processor;
  result.date = today();
  const fs::path sequence = options.out / "sequence";
  make_sequence(options, sequence);
  result.truth = read_trajectory(sequence / "groundtruth.txt");
  result.off = make_run(options, "off", "2/3 nothing left out", result.truth);
  DemoOptions second = options;  // whose page takes the first one's place
  if (options.view) second.port = port_of(page_of(options.out / "off.log"));
  result.best = make_run(second, best_mode, "3/3 people left out", result.truth);
  result.model = model_of(options.out / best_mode);
  result.yolox = !result.model.empty();
  result.frames = choose_frames(result.off, result.best);
  return result;
}

std::string detector_text(const DemoResult& result) {
  return result.yolox ? "YOLOX (" + result.model + ")"
                      : "the motion detector, which needs no model";
}

std::string demo_finding(const DemoResult& result) {
  const double off = result.off.path.error.statistics.rmse;
  const double best = result.best.path.error.statistics.rmse;
  const std::string figures = fmt::format("{:.1f} mm instead of {:.1f} mm", 1e3 * best, 1e3 * off);
  if (best <= 0.0 || off < 1.1 * best) {
    return "The error of the path with people left out is " + figures +
           ": here they made little difference.";
  }
  return fmt::format("With people left out the error of the path is {}, {:.1f} times smaller.",
                     figures, off / best);
}

}  // namespace dkp_slam::apps

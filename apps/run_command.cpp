#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <spdlog/spdlog.h>

#include "apps/commands.h"
#include "apps/run_outputs.h"
#include "dkp_slam/detection/detector_factory.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/slam.h"
#include "dkp_slam/system/stopwatch.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

enum class DetectorChoice { automatic, yolox, motion, none };

struct RunOptions {
  std::string sequence, camera, model, out;
  DynamicsMode mode = DynamicsMode::dkp_plus;
  DetectorChoice detector = DetectorChoice::automatic;
  bool realtime = false;
  std::uint64_t seed = 1;
};

const std::map<std::string, DynamicsMode> modes{{"off", DynamicsMode::off},
                                                {"d", DynamicsMode::d},
                                                {"dk", DynamicsMode::dk},
                                                {"dkp", DynamicsMode::dkp},
                                                {"dkp+", DynamicsMode::dkp_plus}};
const std::map<std::string, DetectorChoice> detectors{{"auto", DetectorChoice::automatic},
                                                      {"yolox", DetectorChoice::yolox},
                                                      {"motion", DetectorChoice::motion},
                                                      {"none", DetectorChoice::none}};

volatile std::sig_atomic_t interrupted = 0;

std::unique_ptr<Detector> make_detector(const RunOptions& options) {
  if (options.mode == DynamicsMode::off || options.detector == DetectorChoice::none) return nullptr;
  YoloxOptions yolox;
  yolox.model = *find_model(options.model);
  return make_yolox_detector(yolox);
}

void run(const RunOptions& options) {
  SlamOptions slam_options;
  slam_options.camera = load_camera(options.camera);
  slam_options.dynamics.mode = options.mode;
  slam_options.realtime = options.realtime;
  slam_options.seed = options.seed;
  fs::create_directories(options.out);
  std::unique_ptr<Detector> detector = make_detector(options);
  Slam slam(slam_options);
  FrontEnd front_end(open_tum_folder(options.sequence, slam_options.camera), std::move(detector),
                     {slam_options.orb, options.realtime});
  std::signal(SIGINT, [](int) { interrupted = 1; });
  RunTotals totals;
  Stopwatch watch;
  while (!interrupted) {
    const std::optional<PreparedFrame> prepared = front_end.next();
    if (!prepared) break;
    FrameReport report = slam.track(*prepared);
    report.frame_ms = watch.lap_ms();
    totals.frames.push_back(report);
  }
  totals.interrupted = interrupted;
  slam.finish(interrupted);
  write_trajectory(fs::path(options.out) / "trajectory.txt", slam.trajectory());
  write_trajectory(fs::path(options.out) / "keyframes.txt", slam.keyframe_trajectory());
  write_file_atomically(fs::path(options.out) / "timings.csv", timings_csv(totals.frames));
  write_file_atomically(fs::path(options.out) / "summary.json",
                        summary_json(totals, slam.map(), {}).dump(2) + "\n");
}

}  // namespace

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand("run", "Localise the camera in an RGB-D sequence");
  command->add_option("SEQUENCE", options->sequence, "Folder in TUM format")->required();
  command->add_option("--camera", options->camera, "Camera file (config/*.yaml)")->required();
  command->add_option("--mode", options->mode, "What to remove")
      ->transform(CLI::CheckedTransformer(modes));
  command->add_option("--detector", options->detector, "What finds people")
      ->transform(CLI::CheckedTransformer(detectors));
  command->add_option("--model", options->model, "YOLOX model file (.onnx)");
  command->add_flag("--realtime", options->realtime, "Play by the clock; drop what comes too late");
  command->add_option("--seed", options->seed, "Seed of everything random");
  command->add_option("--out", options->out, "Output folder")->required();
  command->callback([options] { run(*options); });
}

}  // namespace dkp_slam::apps

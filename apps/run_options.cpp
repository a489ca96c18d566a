#include "apps/run_options.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "apps/frame_rate_option.h"
#include "apps/source_choice.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"

namespace dkp_slam::apps {
namespace {

std::vector<std::string> names_of_modes() {
  std::vector<std::string> names;
  for (const ModeInfo& m : dynamics_modes()) names.emplace_back(m.name);
  return names;
}

void add_detector_options(CLI::App& command, RunOptions& options) {
  auto* recorded = command.add_option(
      "--detections", options.detections,
      "Boxes of this file instead of a detector's, as in an earlier run's detections.txt");
  auto* detector =
      add_shortcut(
          command, options.config, "--detector", "detector.kind",
          "What finds objects that may move: auto (YOLOX when there is a model, else motion), "
          "yolox, motion or none")
          ->check(CLI::IsMember({"auto", "yolox", "motion", "none"}))
          ->default_str("auto")
          ->excludes(recorded);
  auto* model =
      add_shortcut(command, options.config, "--model", "detector.yolox.model",
                   "YOLOX model (.onnx); else DKP_SLAM_MODEL, models/, ~/.cache/dkp-slam");
  add_shortcut(command, options.config, "--provider", "detector.yolox.provider",
               "Execution provider of ONNX Runtime: cpu, cuda or tensorrt")
      ->check(CLI::IsMember({"cpu", "cuda", "tensorrt"}))
      ->default_str("cpu");
  command.add_option("--classes", options.classes,
                     "Weight of each class (YAML, see config/classes.yaml)");
  command
      .add_option("--masks", options.masks,
                  "Mode masks: folder of somebody's segmentation instead of a detector, for each "
                  "colour image a PNG of its name, 8-bit grey, 0 on what is static")
      ->excludes(recorded)
      ->excludes(detector)
      ->excludes(model);
}

/// Throws CLI::ValidationError for options that do not go together.
void check_together(const RunOptions& options, const SlamConfig& config) {
  if (config.realtime && options.one_at_a_time) {
    throw CLI::ValidationError("--one-at-a-time", "not with realtime");
  }
  if (!config.realtime && options.rate) {
    throw CLI::ValidationError("--rate", "needs --realtime: without it nothing is played by time");
  }
  if (options.rate && !(*options.rate > 0.0 && *options.rate <= 100.0)) {
    throw CLI::ValidationError("--rate", "must be above 0 and at most 100");
  }
  if (config.localize_only && options.localize.empty()) {
    throw CLI::ValidationError("localize_only", "needs a map; give --localize FILE instead");
  }
  const DynamicsMode mode = config.dynamics.mode;
  if (options.masks.empty()) {
    if (mode == DynamicsMode::masks && !is_stream(options.sequence)) {
      throw CLI::ValidationError("mode masks", "needs --masks DIR");
    }
  } else if (mode != DynamicsMode::masks && mode != DynamicsOptions().mode) {
    throw CLI::ValidationError(
        "--masks", fmt::format("is a mode of its own, masks, not {}", mode_info(mode).name));
  }
}

/// Throws CLI::ValidationError for options that the source does not go with.
void check_source(const RunOptions& options, const SlamConfig& config) {
  if (options.sequence.empty()) {
    throw CLI::ValidationError("SEQUENCE", "is required, or --source");
  }
  if (options.offline && config.realtime) {
    throw CLI::ValidationError("--offline", "not with realtime");
  }
  if (options.offline && is_kinect(options.sequence)) {
    throw CLI::ValidationError("--offline", "not with a Kinect, which waits for nobody");
  }
  if (options.rate && is_live(options.sequence)) {
    throw CLI::ValidationError("--rate", "not with a camera, which says itself how fast it goes");
  }
  const bool stream = is_stream(options.sequence) || is_kinect(options.sequence);
  if (options.preload && (stream || options.view.wanted)) {
    throw CLI::ValidationError("--preload", "needs a folder, and no --view, which may pause it");
  }
  if (!options.masks.empty() && is_kinect(options.sequence)) {
    throw CLI::ValidationError("--masks", "not with a Kinect, which brings none");
  }
  if (!options.masks.empty() && is_stream(options.sequence)) {
    throw CLI::ValidationError("--masks",
                               "not with a stream, which brings its masks: --mode masks");
  }
  if (!options.masks.empty() && is_bag_file(options.sequence)) {
    throw CLI::ValidationError("--masks",
                               "not with a bag, whose images have no names; `record` "
                               "makes a folder of it");
  }
}

}  // namespace

void add_source_options(CLI::App& command, RunOptions& options) {
  auto* sequence = command.add_option(
      "SEQUENCE", options.sequence,
      "Folder of images in a layout that is known (TUM RGB-D and others, docs/sources.md), a ROS 1 "
      "bag or RealSense recording, or - for a frame stream on the standard input "
      "(docs/frame-stream.md)");
  command
      .add_option("--source", options.sequence,
                  "Instead of SEQUENCE, in real time: kinect, or a socket to listen at for a "
                  "driver's frame stream, unix:PATH, tcp:PORT (of this machine alone) or "
                  "tcp:HOST:PORT")
      ->excludes(sequence);
  command.add_flag("--offline", options.offline,
                   "With a socket: drop no frame, let the driver wait");
  command
      .add_option("--reconnect", options.reconnect,
                  "Seconds that a Kinect, or a driver, that was cut off is waited for")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
}

void add_run_options(CLI::App& command, RunOptions& options) {
  command.add_option("--topics", options.topics,
                     "Of a bag: COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO; default: found by type "
                     "and name");
  command.add_option("--camera", options.camera,
                     fmt::format("Camera file (see config/*.yaml), or {}; else the stream's or "
                                 "bag's own, or SEQUENCE/camera.yaml, else by the folder's layout "
                                 "or name",
                                 camera_names));
  add_frame_rate_option(command, options.frame_rate);
  add_shortcut(command, options.config, "--mode", "mode",
               "What is removed: off (nothing), masks (what --masks say), paper (the paper to the "
               "letter), d (boxes), dk "
               "(clustered masks), dkp (region and epipolar rule), dkp+ (ours); docs/modes.md")
      ->check(CLI::IsMember(names_of_modes()).description(mode_names()))
      ->default_str("dkp+");
  add_detector_options(command, options);
  auto* realtime =
      add_flag_shortcut(command, options.config, "--realtime", "realtime",
                        "Play by the time stamps, drop what comes too late, wait for nothing");
  command.add_option(
      "--rate", options.rate,
      "With --realtime: so many times as fast as it was recorded, above 0 and at most 100; "
      "default: 1");
  command
      .add_flag(
          "--one-at-a-time", options.one_at_a_time,
          "Read a frame when the one before is done: slower, but each stage's time is its own")
      ->excludes(realtime);
  command.add_flag("--preload", options.preload,
                   "Read all images before the first frame: times are then those of a camera, "
                   "which decodes none; 2 MB a frame");
  add_shortcut(command, options.config, "--seed", "seed", "Seed of everything random")
      ->default_str("1");
  add_config_options(command, options.config);
  auto* map = command.add_option("--map", options.map,
                                 "Map file: go on with it where it is there, make it where it is "
                                 "not, and keep it up to date all the time");
  command
      .add_option("--localize", options.localize,
                  "Map file: only find the camera in it, and leave it as it is")
      ->excludes(map);
  command.add_flag("--save-masks", options.save_masks,
                   "Keep the mask of every frame in OUT/masks, for `export --dense`");
  auto* overlay = command.add_flag("--overlay", options.overlay,
                                   "Pictures of boxes, masks and features in OUT/overlay");
  command.add_option("--profile", options.profile,
                     "Trace of all stages and threads, for ui.perfetto.dev (docs/performance.md)");
  command.add_option("--overlay-every", options.overlay_every, "Frames from picture to picture")
      ->check(CLI::Range(1, 1000000))
      ->needs(overlay)
      ->capture_default_str();
}

SlamConfig config_of(const RunOptions& options) {
  SlamConfig config = make_config(options.config);
  check_source(options, config);
  // A camera waits for nobody.
  if (is_live(options.sequence) && !options.offline) config.realtime = true;
  check_together(options, config);
  if (!options.masks.empty()) config.dynamics.mode = DynamicsMode::masks;
  config.localize_only = !options.localize.empty();
  return config;
}

}  // namespace dkp_slam::apps

#include "apps/run_command.h"

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/config_options.h"
#include "apps/live_path.h"
#include "apps/preloaded_source.h"
#include "apps/process.h"
#include "apps/progress.h"
#include "apps/run_dense.h"
#include "apps/run_masks.h"
#include "apps/run_options.h"
#include "apps/run_overlay.h"
#include "apps/run_report.h"
#include "apps/run_view.h"
#include "apps/source_choice.h"
#include "apps/true_path.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/dynamics/parts.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/system/file_observer.h"
#include "dkp_slam/system/map_file/run_map.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"
#include "dkp_slam/trace.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

/// The detector, with all that was left open filled into `config`. Null for none.
std::unique_ptr<Detector> choose_detector(const RunOptions& options, SlamConfig& config) {
  DetectorOptions& detector = config.detector;
  const ModeInfo& mode = mode_info(config.dynamics.mode);
  if (!mode.detector) detector.kind = DetectorKind::none;
  if (detector.kind == DetectorKind::none) {
    spdlog::info("no detector runs ({})",
                 mode.detector ? "detector none" : std::string("mode ") + mode.name);
    return nullptr;
  }
  if (!options.classes.empty()) detector.yolox.classes = ClassTable::load(options.classes);
  if (!options.detections.empty()) {
    return open_recorded_detections(options.detections, detector.yolox.classes);
  }
  if (detector.kind != DetectorKind::motion) {
    if (const auto model = find_model(detector.yolox.model)) {
      detector.kind = DetectorKind::yolox;
      detector.yolox.model = *model;
    }
  }
  return make_detector(detector, config.camera);
}

/// How fast a source is played by its time stamps; 0: as fast as it comes.
double rate_of(const RunOptions& options, const SlamConfig& config) {
  const bool paced = config.realtime && !is_live(options.sequence);
  return paced ? options.rate.value_or(1.0) : 0.0;
}

nlohmann::ordered_json describe(const RunOptions& options, const SlamConfig& config) {
  const bool yolox = config.detector.kind == DetectorKind::yolox;
  nlohmann::ordered_json json;
  json["sequence"] = options.sequence;
  json["camera"] = options.camera;
  json["topics"] = options.topics;
  json["frame_rate"] = options.frame_rate;
  json["mode"] = mode_info(config.dynamics.mode).name;
  json["model"] = yolox ? config.detector.yolox.model.string() : "";
  json["detections"] = options.detections.string();
  json["masks"] = options.masks.string();
  json["classes"] = options.classes.string();
  json["provider"] = yolox ? config.detector.yolox.provider : "";
  json["seed"] = config.seed;
  json["realtime"] = config.realtime;
  if (const double rate = rate_of(options, config); rate > 0.0) {
    json["rate"] = rate;
  } else {
    json["rate"] = nullptr;
  }
  json["map"] = options.map.string();
  json["localize"] = options.localize.string();
  return json;
}

/// Keeps detections.txt: what the detector said of each frame.
class DetectionLog : public FileObserver {
 public:
  explicit DetectionLog(RunLog& log) : log_(log) {}
  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override {
    guard([&] { log_.add(snapshot->frame.timestamp, snapshot->detections); });
  }

 private:
  RunLog& log_;
};

/// Everything of a run that is told what happens.
struct RunObservers {
  std::shared_ptr<RunMap> map;
  std::shared_ptr<DetectionLog> detections;
  std::shared_ptr<OverlayWriter> overlay;  // null without pictures
  std::shared_ptr<MaskWriter> masks;       // null unless they are kept
  std::shared_ptr<LivePath> path;

  void join(Slam& slam, bool with_map) const {
    const ObserverOptions every{Delivery::every};
    slam.add_observer(detections, every);
    if (overlay) slam.add_observer(overlay, every);
    if (masks) slam.add_observer(masks, every);
    slam.add_observer(path, {Delivery::newest});
    if (with_map) slam.add_observer(map, {.map = true});
  }
  void rethrow_failure() const {
    map->rethrow_failure();
    detections->rethrow_failure();
    if (overlay) overlay->rethrow_failure();
    if (masks) masks->rethrow_failure();
  }
};

/// Plays the source to the system. What goes wrong on the way ends the run and is noted.
RunTotals play_run(RgbdSource& source, Slam& slam, const RunObservers& observers, RunLog& log,
                   const PlaybackOptions& playback) {
  RunTotals totals;
  Progress progress("run", source.size());
  const std::clock_t begin = std::clock();  // processor time of all threads
  try {
    play(source, slam, playback, [&](const FrameResult& result) {
      totals.add(result);
      log.add(result, resident_memory_mb());
      observers.rethrow_failure();
      progress.update(
          static_cast<std::size_t>(result.index) + 1,
          result.localised ? fmt::format("{} landmarks", result.tracked_landmarks) : "lost");
    });
    observers.rethrow_failure();
  } catch (const std::exception& error) {
    totals.failure = message_of(error);
  }
  totals.processor_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  totals.skipped_frames = source.skipped();
  totals.frames_without_mask = source.without_mask();
  const SlamCounters counters = slam.counters();
  totals.dropped_frames = counters.dropped;
  totals.detector_failures = counters.detector_failures;
  if (observers.overlay) totals.pictures = observers.overlay->pictures();
  totals.interrupted = interrupted();
  return totals;
}

/// Nothing where the sequence has no true path, or none that fits.
std::optional<ErrorStatistics> error_against_truth(const RunOptions& options,
                                                   const Trajectory& trajectory) {
  if (trajectory.size() < 2) return std::nullopt;
  try {
    const Trajectory truth = true_path(options.sequence, options.frame_rate);
    if (truth.empty()) return std::nullopt;
    return absolute_error(truth, trajectory).statistics;
  } catch (const Error& error) {
    spdlog::warn("not compared with the truth: {}", error.what());
    return std::nullopt;
  }
}

SourceChoice choice_of(const RunOptions& options, const SlamConfig& config) {
  SourceChoice choice;
  choice.name = options.sequence;
  choice.camera = options.camera;
  choice.masks = options.masks;
  choice.stream_masks = config.dynamics.mode == DynamicsMode::masks;
  choice.reconnect = options.reconnect;
  choice.topics = options.topics;
  choice.frame_rate = options.frame_rate;
  return choice;
}

/// Null where nobody wants one.
std::unique_ptr<LiveView> open_view(const RunOptions& options, const SlamConfig& config,
                                    const RgbdSource& source, const std::string& detector) {
  if (!options.view.wanted) return nullptr;
  viewer::SceneInfo info;
  const fs::path folder = fs::path(options.sequence).lexically_normal();
  info.title = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  info.facts = {{"sequence", options.sequence},
                {"mode", mode_info(config.dynamics.mode).name},
                {"detector", detector},
                {"camera", options.camera}};
  info.frames = source.size();
  info.camera = config.camera;
  try {
    info.truth = true_path(folder, options.frame_rate);
  } catch (const Error& error) {
    spdlog::warn("shown without the truth: {}", error.what());
  }
  return std::make_unique<LiveView>(options.view, std::move(info), !config.realtime);
}

/// Those that write into the run's folder, which is there by now.
void open_writers(const RunOptions& options, RunLog& log, RunObservers& observers) {
  if (options.overlay) {
    observers.overlay = std::make_shared<OverlayWriter>(options.out, options.overlay_every);
  }
  if (options.save_masks) {
    observers.masks = std::make_shared<MaskWriter>(options.out);
  } else {
    remove_masks(options.out);
  }
  observers.detections = std::make_shared<DetectionLog>(log);
  observers.path = std::make_shared<LivePath>(options.out);
}

/// What is known of a run before its first frame.
RunResult begin_result(const RunOptions& options, const SlamConfig& config,
                       const std::string& detector) {
  RunResult result;
  result.options = describe(options, config);
  SlamConfig used = config;
  used.dynamics = options_of_mode(config.dynamics);
  result.config = config_json(used);
  result.detector = detector;
  return result;
}

/// What the system and its map hold when the last frame is through.
void take_results(const RunOptions& options, const SlamConfig& config, Slam& slam, RunMap& map,
                  RunResult& result) {
  std::vector<Trajectory> paths = slam.trajectories();
  if (!paths.empty()) {
    result.trajectory = std::move(paths.front());
    result.other_paths.assign(std::make_move_iterator(paths.begin() + 1),
                              std::make_move_iterator(paths.end()));
  }
  try {
    map.finish();
  } catch (const Error& error) {
    if (result.totals.failure.empty()) result.totals.failure = error.what();
  }
  result.keyframes = slam.keyframe_trajectory();
  result.landmarks = slam.map().live_landmarks();
  for (const ClosedLoop& l : slam.loops())
    (l.joined_maps ? result.maps_joined : result.loops_closed)++;
  result.absolute_error = error_against_truth(options, result.trajectory);
  result.readout = check_readout(slam.map(), config.measurement, result.trajectory);
  if (const auto warning = readout_warning(result.readout, config.camera); !warning.empty()) {
    spdlog::warn(warning);
  }
}

}  // namespace

void run(RunOptions options) {
  catch_interrupts();
  SlamConfig config = config_of(options);
  // Everything that can be wrong is found before the first frame; the folder comes last, so that
  // other mistakes leave none behind.
  OpenedSource opened = open_source(choice_of(options, config));
  options.camera = opened.camera_name;
  config.camera = opened.camera;
  auto detector = choose_detector(options, config);
  const std::string detector_name = detector ? detector->name() : "none";
  options.dense.check();
  const auto dense =
      options.dense.any() ? std::make_unique<RunDense>(options.dense, config) : nullptr;
  RunObservers observers;
  observers.map = std::make_shared<RunMap>(options.map, options.localize, config);
  const auto view = open_view(options, config, *opened.source, detector_name);
  if (view) opened.source = view->gated(std::move(opened.source));
  if (options.preload) {
    opened.source = std::make_unique<PreloadedSource>(std::move(opened.source));
  }
  prepare_run_folder(options.out);

  std::optional<TraceRecording> trace;  // outlives the threads that it records
  if (!options.profile.empty()) trace.emplace(options.profile);
  RunLog log(options.out);
  open_writers(options, log, observers);
  RunResult result = begin_result(options, config, detector_name);
  std::optional<Map> stored = observers.map->take_stored();
  const bool with_map = observers.map->begin(config);
  Slam slam(config, std::move(detector), std::move(stored));
  observers.join(slam, with_map);
  if (dense) dense->join(slam);
  if (view) view->join(slam);
  if (view && dense) {
    view->scene().show(std::make_shared<viewer::FusedCloud>(dense->map()));
  }
  PlaybackOptions playback;
  playback.rate = rate_of(options, config);
  playback.one_at_a_time = options.one_at_a_time;
  playback.stop = &interrupt_flag();
  result.totals = play_run(*opened.source, slam, observers, log, playback);
  take_results(options, config, slam, *observers.map, result);
  result.medians = log.medians();
  save_run(result, log, options.out);
  observers.path->remove();
  if (view) view->scene().finish(result.trajectory);
  std::fputs(summary_text(result, options.out).c_str(), stdout);
  if (dense) {
    dense->write();
    if (view) view->scene().touch();  // the last of it was fused just now
  }
  std::fflush(stdout);
  if (trace) trace->finish();
  if (view && options.view.stay) view->stay();
  if (const std::string problem = verdict(result.totals); !problem.empty()) {
    throw Error(fmt::format("{} ({} holds what there is)", problem, options.out.string()));
  }
}

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand(
      "run", "Localise the camera in an RGB-D sequence with people in it; write its path.");
  add_source_options(*command, *options);
  add_run_options(*command, *options);
  command->add_option("--out", options->out, "Folder for the results; made where missing")
      ->required();
  add_dense_file_options(*command, options->dense);
  auto* view =
      command->add_flag("--view", options->view.wanted,
                        "Show the run on a web page, whose address is printed; docs/view.md");
  for (CLI::Option* option : add_server_options(*command, options->view)) option->needs(view);
  command->callback([options] { run(*options); });
}

}  // namespace dkp_slam::apps

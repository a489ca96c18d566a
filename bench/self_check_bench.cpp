// How honest frames are about their poses, on folders with true paths (docs/reliability.md):
// dkp-slam-bench self-check SEQUENCE...

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "bench/benches.h"
#include "bench/truth_offset.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"
#include "tests/support/honesty.h"

namespace dkp_slam::bench {
namespace self_check {
namespace {

namespace fs = std::filesystem;

/// Where in the sequence it is off.
void print_frames(const std::vector<FrameResult>& frames,
                  const std::vector<testing::FrameHonesty>& honesty) {
  fmt::print(
      "index,error_mm,error_mrad,sigma_mm,position_sigmas,orientation_sigmas,landmarks,people_"
      "share,since_map_seen_s\n");
  std::size_t next = 0;
  for (const auto& f : frames) {
    if (next >= honesty.size() || honesty[next].index != f.index) continue;
    const auto& h = honesty[next++];
    fmt::print("{},{:.1f},{:.1f},{:.1f},{:.2f},{:.2f},{},{:.2f},{:.3f}\n", h.index, 1e3 * h.error,
               1e3 * h.turn_error, 1e3 * h.sigma, h.position_off, h.orientation_off,
               f.tracked_landmarks, f.quality.people_share, f.quality.since_map_seen);
  }
}

struct Options {
  std::vector<fs::path> folders;
  std::string camera;  ///< a file; empty: each folder's camera.yaml
  std::string model;   ///< YOLOX weights; empty: the motion detector
  bool each_frame = false;
};

std::vector<FrameResult> played(const fs::path& folder, const Options& options) {
  SlamConfig config;
  config.camera =
      load_camera(options.camera.empty() ? (folder / "camera.yaml").string() : options.camera);
  config.detector.kind = options.model.empty() ? DetectorKind::motion : DetectorKind::yolox;
  config.detector.yolox.model = options.model;
  const auto source = open_tum_folder(folder.string(), config.camera);
  Slam slam(config, make_detector(config.detector, config.camera));
  std::vector<FrameResult> frames;
  play(*source, slam, {}, [&](const FrameResult& result) { frames.push_back(result); });
  return frames;
}

void measure(const fs::path& folder, const Options& options) {
  const auto frames = played(folder, options);
  const auto truth = read_trajectory(folder / "groundtruth.txt");
  const auto h = testing::honesty_of(frames, truth);
  const auto offset = truth_offset(frames, truth);
  const auto then = testing::honesty_of(frames, without_offset(truth, offset));
  fmt::print(
      "| `{}` | {} of {} | {} | {:.1f} | {:.1f}, {:.1f} mm | {:.1f} mm | {:.0f} mm, {:.0f} mrad, "
      "{:.0f} ms | {} | {:.1f} | {:.1f}, {:.1f} mm |\n",
      folder.filename().string(), h.localised, frames.size(), h.over_three_sigma, h.worst,
      1e3 * h.median_error, 1e3 * h.largest_error, 1e3 * h.median_sigma,
      1e3 * offset.camera_from_body.translation.norm(), 1e3 * offset.camera_from_body.angle(),
      1e3 * offset.seconds, then.over_three_sigma, then.worst, 1e3 * then.median_error,
      1e3 * then.largest_error);
  if (options.each_frame) print_frames(frames, then.frames);
  std::fflush(stdout);
}

void run(const Options& options) {
  fmt::print(
      "| sequence | localised | over 3 sigma | worst | error, median and largest | told sigma "
      "| the true path's own offset | over 3 sigma without it | worst | error |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const fs::path& folder : options.folders) measure(folder, options);
}

}  // namespace
}  // namespace self_check

void add_self_check(CLI::App& program) {
  CLI::App* app = program.add_subcommand("self-check", "How honest frames are about their poses");
  const auto options = std::make_shared<self_check::Options>();
  app->add_option("SEQUENCE", options->folders, "Folders in TUM format with a groundtruth.txt")
      ->required();
  app->add_option("--camera", options->camera,
                  "Camera file of all of them; else each one's camera.yaml");
  app->add_option("--model", options->model, "YOLOX weights; without it the motion detector");
  app->add_flag("--frames", options->each_frame,
                "Below each sequence a line for every localised frame, the truth's offset removed");
  app->callback([options] { self_check::run(*options); });
}

}  // namespace dkp_slam::bench

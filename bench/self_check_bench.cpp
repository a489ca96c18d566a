// How honest frames are about their poses, on folders with true paths (docs/reliability.md):
// build/release/bench/self_check_bench SEQUENCE...
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"
#include "tests/support/honesty.h"

namespace {

namespace fs = std::filesystem;

/// Where in the sequence it is off.
void print_frames(const std::vector<dkp_slam::FrameResult>& frames,
                  const std::vector<dkp_slam::testing::FrameHonesty>& honesty) {
  fmt::print("index,error_mm,sigma_mm,sigmas_off,landmarks,people_share,since_map_seen_s\n");
  std::size_t next = 0;
  for (const auto& f : frames) {
    if (next >= honesty.size() || honesty[next].index != f.index) continue;
    const auto& h = honesty[next++];
    fmt::print("{},{:.1f},{:.1f},{:.2f},{},{:.2f},{:.3f}\n", h.index, 1e3 * h.error, 1e3 * h.sigma,
               h.sigmas_off, f.tracked_landmarks, f.quality.people_share, f.quality.since_map_seen);
  }
}

void measure(const fs::path& folder, const std::string& camera_file, bool each_frame) {
  dkp_slam::SlamConfig config;
  config.camera =
      dkp_slam::load_camera(camera_file.empty() ? (folder / "camera.yaml").string() : camera_file);
  config.detector.kind = dkp_slam::DetectorKind::motion;
  const auto source = dkp_slam::open_tum_folder(folder.string(), config.camera);
  dkp_slam::Slam slam(config, dkp_slam::make_detector(config.detector, config.camera));
  std::vector<dkp_slam::FrameResult> frames;
  dkp_slam::play(*source, slam, {},
                 [&](const dkp_slam::FrameResult& result) { frames.push_back(result); });
  const auto truth = dkp_slam::read_trajectory(folder / "groundtruth.txt");
  const auto h = dkp_slam::testing::honesty_of(frames, truth);
  fmt::print("| `{}` | {} of {} | {} | {:.1f} sigma | {:.1f}, {:.1f} mm | {:.1f} mm |\n",
             folder.filename().string(), h.localised, frames.size(), h.over_three_sigma, h.worst,
             1e3 * h.median_error, 1e3 * h.largest_error, 1e3 * h.median_sigma);
  if (each_frame) print_frames(frames, h.frames);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("How honest frames are about their poses, with the motion detector");
  std::vector<fs::path> folders;
  std::string camera;
  app.add_option("SEQUENCE", folders, "Folders in TUM format with a groundtruth.txt")->required();
  app.add_option("--camera", camera, "Camera file of all of them; else each one's camera.yaml");
  bool each_frame = false;
  app.add_flag("--frames", each_frame, "Below each sequence a line for every localised frame");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "| sequence | localised | over 3 sigma | worst | error, median and largest | told sigma |\n"
      "|---|---|---|---|---|---|\n");
  try {
    for (const fs::path& folder : folders) measure(folder, camera, each_frame);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}

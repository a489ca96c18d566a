#include "dkp_slam/synth/folder/synthetic_folder.h"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/synth/folder/sequence_writer.h"
#include "dkp_slam/version.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

// Written first and by nothing else: a folder that holds it may be replaced.
const std::string marker = "synth.json";

/// Makes the folder with nothing of ours in it.
void prepare_folder(const fs::path& out) {
  try {
    fs::create_directories(out);
    check_writable(out / marker);
    for (const std::string& name : SequenceWriter::names()) fs::remove_all(out / name);
  } catch (const fs::filesystem_error& error) {
    throw Error(
        fmt::format("{}: cannot prepare the folder: {}", out.string(), error.code().message()));
  }
}

void write_description(const fs::path& out, const SyntheticOptions& options, std::size_t frames) {
  const DepthCorrection& depth = options.camera.depth_correction;
  const nlohmann::ordered_json description = {
      {"program", std::string("dkp-slam ") + DKP_SLAM_VERSION},
      {"scenario", options.scenario},
      {"seed", options.seed},
      {"frames", frames},
      {"width", options.camera.width},
      {"height", options.camera.height},
      {"rate", options.camera.frame_rate},
      {"trajectory", options.trajectory.string()},
      {"noise", options.kinect_noise ? "kinect" : "none"},
      {"rolling_shutter", options.camera.readout > 0.0},
      {"readout", options.camera.readout},
      {"depth_scale", options.camera.depth_scale},
      {"depth_delay", depth.delay},
      {"depth_bias", depth.bias},
      {"depth_distortion", std::vector<double>(depth.distortion.coefficients.begin(),
                                               depth.distortion.coefficients.end())}};
  write_file_atomically(out / marker, json_text(description) + "\n");
}

}  // namespace

void check_synthetic_folder(const fs::path& out, bool force) {
  std::error_code unreadable;
  if (!fs::exists(out, unreadable)) return;
  if (!fs::is_directory(out, unreadable)) {
    throw Error(out.string() + ": is no folder; give another one");
  }
  if (!fs::is_empty(out, unreadable) && !fs::exists(out / marker, unreadable) && !force) {
    throw Error(
        fmt::format("{}: is not empty and was not made by synth; give another folder, or "
                    "--force (Python: force=True) to write into it",
                    out.string()));
  }
}

std::size_t write_synthetic_folder(const fs::path& out, const SyntheticOptions& options,
                                   SyntheticSource& source, const SynthProgress& go_on) {
  prepare_folder(out);
  write_description(out, options, *source.size());
  SequenceWriter writer(out, options.camera);
  std::size_t done = 0;
  try {
    while (go_on(done)) {
      const auto frame = source.read();
      if (!frame) break;
      writer.add(*frame, source.truth());
      ++done;
    }
    writer.finish(source);
  } catch (const Error& error) {
    // Without lists they would be images and no sequence.
    writer.finish(source);
    throw Error(fmt::format("{} ({} holds the frames before it)", error.what(), out.string()));
  }
  return done;
}

}  // namespace dkp_slam

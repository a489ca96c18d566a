#include "apps/run_report.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

constexpr std::array files = {"trajectory.txt", "keyframes.txt", "detections.txt", "timings.csv",
                              "summary.json"};

/// Megabytes that the process has had in memory at most, as the kernel counts (VmHWM).
double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0.0;
}

/// Of the frames' paths, the longest being the first.
std::string path_name(std::size_t number) {
  return number == 1 ? files[0] : fmt::format("trajectory_{}.txt", number);
}

std::vector<std::size_t> frames_per_map(const RunResult& result) {
  std::vector<std::size_t> frames;
  if (!result.trajectory.empty()) frames.push_back(result.trajectory.size());
  for (const Trajectory& t : result.other_paths) frames.push_back(t.size());
  return frames;
}

double rounded(double value, double digits) { return std::round(value * digits) / digits; }

}  // namespace

void RunTotals::add(const FrameResult& frame) {
  ++frames;
  localised += frame.localised;
  detections += frame.detections;
  compensated += frame.compensated;
  features += frame.features;
  removed_features += frame.removed_features;
}

double resident_memory_mb() {
  std::ifstream status("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  status >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

nlohmann::ordered_json summary_json(const RunResult& result) {
  const RunTotals& totals = result.totals;
  nlohmann::ordered_json json;
  json["version"] = DKP_SLAM_VERSION;
  json["options"] = result.options;
  json["config"] = result.config;
  json["detector"] = result.detector;
  json["interrupted"] = totals.interrupted;
  json["failure"] = verdict(totals);
  json["frames"] = totals.frames;
  json["localised_frames"] = totals.localised;
  json["lost_frames"] = totals.frames - totals.localised;
  json["skipped_frames"] = totals.skipped_frames;
  json["frames_without_mask"] = totals.frames_without_mask;
  json["dropped_frames"] = totals.dropped_frames;
  json["detections"] = totals.detections;
  json["compensated_detections"] = totals.compensated;
  json["detector_failures"] = totals.detector_failures;
  json["features"] = totals.features;
  json["features_removed"] = totals.removed_features;
  json["keyframes"] = result.keyframes.size();
  json["landmarks"] = result.landmarks;
  json["loops_closed"] = result.loops_closed;
  json["maps"] = frames_per_map(result);
  json["maps_joined"] = result.maps_joined;
  if (result.absolute_error) {
    json["ate"] = {{"poses", result.absolute_error->count},
                   {"rmse_m", rounded(result.absolute_error->rmse, 1e6)}};
  }
  if (result.readout.groups > 0) {
    json["readout_check"] = {{"change_ms", rounded(1000.0 * result.readout.change, 100.0)},
                             {"sigma_ms", rounded(1000.0 * result.readout.sigma, 100.0)}};
  }
  nlohmann::ordered_json medians;
  for (const StageMedian& m : result.medians) medians[m.stage] = rounded(m.ms, 1000.0);
  json["median_ms"] = medians;
  const double frames = std::max<double>(1.0, static_cast<double>(totals.frames));
  json["processor_ms_per_frame"] = rounded(1000.0 * totals.processor_s / frames, 1000.0);
  json["peak_memory_mb"] = rounded(peak_memory_mb(), 10.0);
  return json;
}

std::string summary_text(const RunResult& result, const fs::path& out) {
  const RunTotals& totals = result.totals;
  std::string text = fmt::format("{} of {} frames localised, {} lost", totals.localised,
                                 totals.frames, totals.frames - totals.localised);
  if (totals.skipped_frames > 0) text += fmt::format(", {} not readable", totals.skipped_frames);
  if (totals.frames_without_mask > 0) {
    text += fmt::format(", {} without mask", totals.frames_without_mask);
  }
  if (totals.dropped_frames > 0) text += fmt::format(", {} dropped", totals.dropped_frames);
  text += fmt::format("; {} keyframes, {} landmarks", result.keyframes.size(), result.landmarks);
  if (result.loops_closed > 0) text += fmt::format(", {} loops closed", result.loops_closed);
  if (result.maps_joined > 0) text += fmt::format(", {} maps joined", result.maps_joined);
  text += '\n';
  if (!result.other_paths.empty()) {
    text +=
        fmt::format("{} maps that never met, of {} frames: {} has the longest path, {} the next\n",
                    result.other_paths.size() + 1, fmt::join(frames_per_map(result), ", "),
                    files[0], path_name(2));
  }

  const long features = totals.features, removed = totals.removed_features;
  text += fmt::format("detector {}: {} detections, {} carried over a missed one", result.detector,
                      totals.detections, totals.compensated);
  if (totals.detector_failures > 0) text += ", FAILED in the middle";
  text += fmt::format("; {} of {} features removed ({:.1f} %)\n", removed, features,
                      features > 0 ? 100.0 * double(removed) / double(features) : 0.0);

  text += "median ms:";
  for (const StageMedian& m : result.medians) {
    text += fmt::format("{} {} {:.1f}", &m == &result.medians.front() ? "" : ",", m.stage, m.ms);
  }
  text += fmt::format("; peak memory {:.0f} MB\n", peak_memory_mb());
  if (result.absolute_error) {
    text += fmt::format("ATE {:.4f} m (RMSE, {} poses, by the truth of the sequence)\n",
                        result.absolute_error->rmse, result.absolute_error->count);
  }
  text += fmt::format("in {}: {}", out.string(), fmt::join(files, ", "));
  if (totals.pictures > 0) text += fmt::format(", {} pictures in overlay/", totals.pictures);
  return text + "\n";
}

void prepare_run_folder(const fs::path& out) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) {
    throw Error(fmt::format("cannot make the output folder {}: {}; choose another --out",
                            out.string(), error.message()));
  }
  for (const char* file : files) check_writable(out / file);
}

void save_run(const RunResult& result, RunLog& log, const fs::path& out) {
  write_trajectory(out / files[0], result.trajectory);
  std::size_t number = 2;
  for (const Trajectory& t : result.other_paths) write_trajectory(out / path_name(number++), t);
  for (; fs::exists(out / path_name(number)); ++number) fs::remove(out / path_name(number));
  write_trajectory(out / files[1], result.keyframes);
  log.save();
  write_file_atomically(out / files[4], json_text(summary_json(result)) + "\n");
}

std::string verdict(const RunTotals& totals) {
  if (!totals.failure.empty()) return totals.failure;
  const std::size_t seen = totals.frames, localised = totals.localised;
  if (totals.interrupted) return fmt::format("interrupted after {} frames", seen);
  if (localised == 0) {
    return fmt::format(
        "none of {} frames was localised; do camera file and sequence belong together?", seen);
  }
  const std::size_t all = seen + totals.skipped_frames;
  if (2 * localised < all) {
    return fmt::format("{} of {} frames were lost or not readable, more than half", all - localised,
                       all);
  }
  return "";
}

}  // namespace dkp_slam::apps

#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/run_log.h"
#include "dkp_slam/calibration/readout_check.h"
#include "dkp_slam/evaluation/statistics.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam::apps {

/// What the frames of a run amounted to.
struct RunTotals {
  std::size_t frames = 0;
  std::size_t localised = 0;
  long detections = 0, compensated = 0;  ///< see FrameResult
  long features = 0, removed_features = 0;
  std::size_t skipped_frames = 0;       ///< images that could not be read
  std::size_t frames_without_mask = 0;  ///< of masks that were given
  int dropped_frames = 0;               ///< too late in real time
  int detector_failures = 0;
  int pictures = 0;          ///< of the overlay
  double processor_s = 0.0;  ///< of all threads, from the first frame to the last adjustment
  bool interrupted = false;
  std::string failure;  ///< what ended the run early; empty when nothing did

  void add(const FrameResult& frame);
};

/// Everything a run leaves behind.
struct RunResult {
  RunTotals totals;
  std::vector<StageMedian> medians;
  Trajectory trajectory, keyframes;
  std::vector<Trajectory> other_paths;  ///< in maps that never met that of the trajectory
  int landmarks = 0;
  int loops_closed = 0;
  int maps_joined = 0;
  std::string detector;            ///< "none", or the name of the one that was chosen
  nlohmann::ordered_json options;  ///< what the user asked for and what was chosen for him
  nlohmann::ordered_json config;   ///< all options of the run, see config_json
  ReadoutCheck readout;
  /// Of the trajectory, metres, where the sequence brings its true path.
  std::optional<ErrorStatistics> absolute_error;
};

/// Megabytes that the process has in memory now (statm).
double resident_memory_mb();

/// Counts and medians of a run.
nlohmann::ordered_json summary_json(const RunResult& result);

/// The same in a few lines to read.
std::string summary_text(const RunResult& result, const std::filesystem::path& out);

/// Makes the folder and throws `Error` where the files of a run could not be written into it now.
void prepare_run_folder(const std::filesystem::path& out);

/// Writes trajectory.txt, keyframes.txt, what the log holds and summary.json, each whole or not at
/// all; and trajectory_2.txt and so on for other paths, of which none is left from an
/// earlier run.
void save_run(const RunResult& result, RunLog& log, const std::filesystem::path& out);

/// Why the run counts as failed, one line; empty when it does not. Fails: a run that ended early,
/// that localised nothing, or that lost or could not read more than half of the frames.
std::string verdict(const RunTotals& totals);

}  // namespace dkp_slam::apps

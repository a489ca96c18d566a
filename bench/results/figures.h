#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/measure/timings.h"

namespace dkp_slam::bench {

/// One run of the program: a sequence, an ablation mode and a seed.
struct RunKey {
  std::string sequence;
  std::string mode;  ///< as on the command line, see `bench_modes`
  std::uint64_t seed = 1;
};

/// What one run gave.
struct RunFigures {
  RunKey key;
  std::string problem;  ///< why there are no figures; empty after a good run
  /// False: the first seed's detections were played, one frame at a time. Path and times of
  /// tracking are the same as with a detector; what the whole process takes is not measured.
  bool whole = true;
  std::size_t frames = 0;
  std::size_t lost_frames = 0;                  ///< without a pose in the trajectory
  double ate_rmse = 0.0, ate_deviation = 0.0;   ///< metres
  std::optional<double> rpe_second, rpe_frame;  ///< translation, RMSE, metres over 1 s and 1 frame
  std::optional<double> rpe_degrees;            ///< rotation, RMSE, degrees over 1 s
  std::map<std::string, double> stage_ms;       ///< medians over frames, by column of timings.csv
  /// Median of features, clustering, removal and tracking, in a second run that reads
  /// its detections from a file.
  double without_detection_ms = 0.0;
  double peak_memory_mb = 0.0;
  double wall_s = 0.0;        ///< the process from start to end
  double processor_s = 0.0;   ///< of all its threads
  double others_share = 0.0;  ///< of the machine's processor time that other programs took, 0 to 1
};

/// How the masks and features of one run compare with the truth; shares, 0 to 1.
struct MaskFigures {
  RunKey key;
  std::size_t scored_frames = 0;
  std::optional<double> iou, removed, kept;
};

struct Results {
  std::vector<RunFigures> runs;
  std::vector<MaskFigures> masks;
};

enum class Quantity {
  ate,
  ate_deviation,
  lost_frames,
  rpe_second,
  rpe_frame,
  rpe_degrees,
  frame_ms,
  without_detection_ms,
  processor_ms,  ///< per frame, all threads
  wall_ms,       ///< per frame, starting and the final adjustment included
  peak_memory,
  mask_iou,
  features_removed,
  features_kept,
};

/// The quantity in every good run of a sequence and mode, in the order of measuring.
std::vector<double> values(const Results& results, const std::string& sequence,
                           const std::string& mode, Quantity quantity);

/// A stage's median time over the frames in every good run, milliseconds; `stage` as in timings.csv
/// without "_ms".
std::vector<double> stage_values(const Results& results, const std::string& sequence,
                                 const std::string& mode, const std::string& stage);

/// The median where there is a value.
std::optional<double> median_of(const std::vector<double>& values);

/// Fills in the medians of the stages from a timings.csv.
void set_times(RunFigures& figures, const std::map<std::string, std::vector<double>>& timings);

}  // namespace dkp_slam::bench

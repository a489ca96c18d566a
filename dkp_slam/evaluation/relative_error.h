#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/statistics.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// What the step between the two poses of a pair is measured in.
enum class StepUnit {
  seconds,
  frames,   ///< poses of the estimate
  metres,   ///< along the estimated path
  radians,  ///< turned along the estimated path
  degrees,
};

/// "s", "f", "m", "rad" or "deg", as in the benchmark's tools.
std::string short_name(StepUnit unit);

struct RelativeErrorOptions {
  /// Step of the pairs, in `unit`. The benchmark reports drift per second.
  double delta = 1.0;
  StepUnit unit = StepUnit::seconds;
  /// Compare every pose with every other instead of over a fixed step.
  bool all_pairs = false;
  /// More pairs than this are sampled, as in the benchmark; 0: never.
  std::size_t max_pairs = 10000;
  /// Of the sampling.
  std::uint64_t seed = 0;
  /// Seconds added to the stamps of the estimate, for clocks that differ.
  double offset = 0.0;
};

/// The error of the motion between two poses of the estimate.
struct RelativeErrorSample {
  double from = 0.0;  ///< seconds, time stamp in the estimate
  double to = 0.0;
  double translation = 0.0;  ///< metres
  double rotation = 0.0;     ///< radians in [0, pi]
};

/// Relative pose error (RPE): drift over a step.
struct RelativeError {
  std::vector<RelativeErrorSample> samples;
  ErrorStatistics translation;  ///< metres
  ErrorStatistics rotation;     ///< radians
};

/// RPE as the TUM benchmark's evaluate_rpe.py computes it (Sturm et al., IROS 2012), with its
/// rules: each pose of the estimate is paired with the one nearest to a step later, pairs that end
/// in the last pose are left out, each pose is compared with the ground truth pose nearest in time
/// (no interpolation), and pairs without one within two median ground truth intervals are left out.
/// The script takes angles from the trace and so shows some 1e-8 rad where there is no rotation;
/// here they are exact. Where pairs are sampled the choice is ours, so figures differ a little from
/// the script's. Both trajectories in the order of their stamps. Throws `Error` when fewer than two
/// pairs can be compared.
RelativeError relative_error(std::span<const StampedPose> truth,
                             std::span<const StampedPose> estimate,
                             const RelativeErrorOptions& options = {});

}  // namespace dkp_slam

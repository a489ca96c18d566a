#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

struct AssociationOptions {
  /// Stamps this far apart or further, seconds, do not match. The benchmark's default: a little
  /// more than half the time between two frames at 30 Hz.
  double max_difference = 0.02;
  /// Seconds added to the stamps of the estimate, for clocks that differ.
  double offset = 0.0;
};

/// Indices of two poses that belong to one moment.
struct PoseMatch {
  std::size_t truth = 0;
  std::size_t estimate = 0;
};

/// Pairs poses by time stamp as the TUM benchmark's associate.py does: the nearest pair first, each
/// pose once. Both trajectories are in the order of their stamps, and so is the result.
std::vector<PoseMatch> associate(std::span<const StampedPose> truth,
                                 std::span<const StampedPose> estimate,
                                 const AssociationOptions& options = {});

/// Index of the value nearest to `wanted` in an ascending, non-empty sequence. Of equally near ones
/// it takes the one that bisection meets first, as the benchmark's evaluate_rpe.py does.
std::size_t nearest_index(std::span<const double> ascending, double wanted);

/// The time stamps of these poses, seconds.
std::vector<double> stamps_of(std::span<const StampedPose> poses);

}  // namespace dkp_slam

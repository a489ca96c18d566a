#pragma once

#include <span>
#include <vector>

#include "dkp_slam/evaluation/association.h"
#include "dkp_slam/evaluation/statistics.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// Absolute trajectory error (ATE): how far each position is from the truth once the whole
/// estimated path is laid over the true one.
struct AbsoluteError {
  Se3 truth_from_estimate;         ///< the alignment: estimate's world frame to the truth's
  std::vector<PoseMatch> matches;  ///< what was compared, in the order of time
  std::vector<double> errors;      ///< metres, one per match
  ErrorStatistics statistics;      ///< metres
};

/// ATE as the TUM benchmark's evaluate_ate.py computes it (Sturm et al., A Benchmark for the
/// Evaluation of RGB-D SLAM Systems, IROS 2012): poses associated by time stamp, aligned by the
/// rigid motion, without scale, that is best in least squares (Horn, JOSA A 1987). Both
/// trajectories in the order of their stamps. Throws `Error` when fewer than two poses match, with
/// the stamps of each.
AbsoluteError absolute_error(std::span<const StampedPose> truth,
                             std::span<const StampedPose> estimate,
                             const AssociationOptions& options = {});

}  // namespace dkp_slam

#pragma once

#include <span>
#include <string>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/canvas.h"

namespace dkp_slam {

/// The path of one run beside the truth.
struct ScoredPath {
  std::string name;  ///< in the legend
  Colour colour;
  Trajectory estimate;
  AbsoluteError error;  ///< of this estimate
};

/// Of the truth what lies within the time of the estimates, of which there is one and none is
/// empty: elsewhere there is nothing to compare.
Trajectory truth_during(std::span<const StampedPose> truth, std::span<const ScoredPath> paths,
                        const AssociationOptions& association = {});

/// The first stamp of these paths, seconds.
double start_of(std::span<const ScoredPath> paths);

}  // namespace dkp_slam

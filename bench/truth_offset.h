#pragma once

#include <vector>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam {

/// What a measured true path is off in all of its poses alike: motion capture tells where the
/// markers are, and when by a clock of its own.
struct TruthOffset {
  Se3 camera_from_body;  ///< where the path's frame sits in the camera's: the identity, if right
  double seconds = 0.0;  ///< what was at t is in the path at t + seconds, from -0.02 to 0.02
};

/// Estimated from poses as told at the time, each by its covariance, with Cauchy's weights; held
/// near none (3 cm, 50 mrad) where the motion does not tell. At least one must be localised.
TruthOffset truth_offset(const std::vector<FrameResult>& frames, const Trajectory& truth);

/// The path of the camera itself.
Trajectory without_offset(const Trajectory& truth, const TruthOffset& offset);

}  // namespace dkp_slam

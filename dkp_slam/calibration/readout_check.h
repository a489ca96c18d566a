#pragma once

#include <string>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// What a finished map says of the readout of its camera file.
struct ReadoutCheck {
  double change = 0.0;  ///< seconds, to be added to the file's
  double sigma = 0.0;   ///< its standard deviation, seconds
  int groups = 0;       ///< pieces of the path that told it; 0: nothing is known
};

/// Asks the residuals that the adjustment has left. The map's keyframes are cut into groups of
/// six that follow each other; in each of them poses, landmarks and the readout take one
/// Gauss-Newton step from where they are, of which what is said of the readout is kept (landmarks
/// and poses eliminated by the Schur complement, Triggs et al. 2000, §6.1). Standard deviation by
/// the jackknife over groups. A map that was made with a wrong readout has lost what contradicts
/// it, so three quarters of the error are found, not all. `path`: of the run, for the camera's
/// velocity; keyframes that do not lie on it are passed over. Changes nothing.
ReadoutCheck check_readout(const Map& map, const MeasurementModel& model, const Trajectory& path);

/// One line that says what is wrong and what to do; empty unless the readout is off by more than
/// 8 ms and five standard deviations.
std::string readout_warning(const ReadoutCheck& check, const Camera& camera);

}  // namespace dkp_slam

#pragma once

#include <limits>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam {

/// Says of frame after frame how far its pose can be trusted.
class SelfCheck {
 public:
  SelfCheck(const Map& map, const MeasurementModel& model) : map_(map), model_(model) {}

  /// `frame` as the tracker left it; `tracked`: landmarks that its pose rests on.
  PoseQuality check(const Frame& frame, bool localised, int tracked, const FrameDynamics& dynamics);

 private:
  Eigen::Matrix<double, 6, 6> covariance(const Frame& frame) const;

  const Map& map_;
  const MeasurementModel model_;
  double map_seen_ = -std::numeric_limits<double>::infinity();
  Eigen::Matrix<double, 6, 6> last_ = PoseQuality::unknown();  ///< where the map was last seen
};

}  // namespace dkp_slam

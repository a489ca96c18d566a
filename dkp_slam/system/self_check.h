#pragma once

#include <limits>
#include <vector>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/pose_optimizer.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam {

/// Says of frame after frame how far its pose can be trusted.
class SelfCheck {
 public:
  SelfCheck(const Map& map, const MeasurementModel& model)
      : map_(map), model_(model), doubts_(static_cast<std::size_t>(map.keyframe_ids())) {}

  /// `frame` as the tracker left it; `tracked`: landmarks that its pose rests on.
  PoseQuality check(const Frame& frame, bool localised, int tracked, const FrameDynamics& dynamics);

 private:
  /// Standard deviations of something that is believed beside what the landmarks measure.
  struct Doubt {
    double way = 0.0, angle = 0.0;  ///< metres, radians
  };

  struct Evidence {
    std::vector<PoseObservation> observations;
    bool of_others;  ///< of landmarks that the frame has not made itself
  };
  Evidence evidence(const Frame& frame) const;
  Matrix6d measurement_covariance(const Se3& camera_from_world,
                                  const std::vector<PoseObservation>& observations) const;
  void compare_groups(const Frame& frame, const std::vector<PoseObservation>& observations);
  Doubt inherited_doubt(const Frame& frame) const;
  Doubt carried_doubt(const Frame& frame) const;
  static Doubt handed_on(const Matrix6d& believed);

  const Map& map_;
  const MeasurementModel model_;
  double map_seen_ = -std::numeric_limits<double>::infinity();
  int map_placed_in_ = -1;                      ///< the last frame that saw a map
  Matrix6d believed_ = PoseQuality::unknown();  ///< where it was seen, but for common errors
  Matrix6d last_ = PoseQuality::unknown();      ///< and with them
  Doubt contest_;                               ///< near and far do not agree where the camera is
  double contested_ = 0.0;                      ///< timestamp of the last such frame
  std::vector<Doubt> doubts_;                   ///< by keyframe id: what it hands on
};

}  // namespace dkp_slam

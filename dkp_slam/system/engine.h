#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/system/back_end.h"
#include "dkp_slam/system/config.h"
#include "dkp_slam/system/feature_refill.h"
#include "dkp_slam/system/frame_pipeline.h"
#include "dkp_slam/system/frame_result.h"
#include "dkp_slam/system/pose_log.h"
#include "dkp_slam/system/self_check.h"
#include "dkp_slam/system/start_keyframe.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// What happens to a prepared frame, step after step on the thread that calls: dynamics, pose,
/// keyframe, map. Slam feeds it.
class Engine {
 public:
  /// `stored`: a map to start from, made with this camera (see check_fits).
  explicit Engine(const SlamConfig& config, std::optional<Map> stored = std::nullopt);

  /// Localises one frame and grows the map. Frames come in order.
  std::shared_ptr<FrameSnapshot> track(PreparedFrame prepared);

  /// Ends the run: waits for the adjustment under way and does the final one, unless `stop` is set
  /// before that is done.
  void finish(const std::atomic<bool>* stop = nullptr);

  /// Poses of all localised frames, by time, with everything known so far: one path per map that
  /// any were localised in, each in its own world frame, the longest first.
  std::vector<Trajectory> trajectories() const;
  /// Poses of this run's keyframes in the map of the longest path.
  Trajectory keyframe_trajectory() const;

  const Map& map() const { return map_; }
  const std::vector<ClosedLoop>& loops() const { return back_end_.loops(); }

 private:
  /// Maps that frames were localised in, most frames first.
  std::vector<int> maps_in_use() const;
  void localize(const PreparedFrame& prepared, FrameSnapshot& snapshot);

  const SlamConfig config_;
  Map map_;
  const int first_keyframe_;  // of this run
  PlaceIndex places_;         // follows the map's locking rule: the tracking thread's alone
  BackEnd back_end_;
  Tracker tracker_;
  PoseLog poses_;  // of all localised frames of this run
  DynamicsModule dynamics_;
  FeatureRefill refill_;
  StartKeyframe start_;
  SelfCheck self_check_;
};

}  // namespace dkp_slam

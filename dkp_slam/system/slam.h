#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/system/back_end.h"
#include "dkp_slam/system/config.h"
#include "dkp_slam/system/front_end.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// What happened to one frame.
struct FrameReport {
  int index = 0;
  double timestamp = 0.0;
  bool localised = false;
  int features = 0;
  int removed_features = 0;  ///< called dynamic
  int tracked_landmarks = 0;
  int detections = 0;   ///< in this frame, scores high enough to start an object
  int compensated = 0;  ///< objects carried without a detection
  bool keyframe = false;
  int map_keyframes = 0, map_landmarks = 0;  ///< in all maps, after the frame
  double resident_mb = 0.0;  ///< memory of the whole process, where somebody measured it
  double decode_ms = 0.0, feature_ms = 0.0,
         detection_ms = 0.0;  ///< in threads ahead of the tracker
  double clustering_ms = 0.0, removal_ms = 0.0, tracking_ms = 0.0;
  double frame_ms = 0.0;  ///< from the last frame's end to this one's, all threads working
};

/// The whole system: feed it frames in order, then ask for the poses.
class Slam {
 public:
  /// `stored`: a map to start from, made with this camera (see check_fits).
  explicit Slam(const SlamConfig& options, std::optional<Map> stored = std::nullopt);

  /// Localises one frame and grows the map. `dynamics_out`, when given, receives what was found out
  /// about moving things, for pictures.
  FrameReport track(const PreparedFrame& prepared, FrameDynamics* dynamics_out = nullptr);

  /// Ends the run: waits for the adjustment under way and does the final one, unless `stop` is set
  /// before that is done.
  void finish(const std::atomic<bool>* stop = nullptr);

  /// Poses of all localised frames, by time, with everything known so far: one path per map that
  /// any were localised in, each in its own world frame, the longest first.
  std::vector<Trajectory> trajectories() const;
  /// The longest of them.
  Trajectory trajectory() const;
  /// Poses of this run's keyframes in the map of the longest path.
  Trajectory keyframe_trajectory() const;

  const Map& map() const { return map_; }
  const std::vector<ClosedLoop>& loops() const { return back_end_.loops(); }

 private:
  /// Maps that frames were localised in, most frames first.
  std::vector<int> maps_in_use() const;

  const SlamConfig options_;
  Map map_;
  const int first_keyframe_;  // of this run
  PlaceIndex places_;         // follows the map's locking rule: the tracking thread's alone
  BackEnd back_end_;
  Tracker tracker_;
  DynamicsModule dynamics_;
};

}  // namespace dkp_slam

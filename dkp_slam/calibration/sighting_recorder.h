#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "dkp_slam/calibration/sightings.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/config.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam {

/// Keeps what each frame saw of the map. To be added with Delivery::every.
class SightingRecorder : public SlamObserver {
 public:
  explicit SightingRecorder(const SlamConfig& config)
      : camera_(config.camera), level_scale_(config.orb.scale) {}

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;

  /// After Slam::finish: the frames that lie on this path, with the poses of the path.
  std::vector<SightedFrame> frames_on(const Trajectory& path) const;

 private:
  /// Where a feature was when its depth image was taken, raw pixel, by how its landmark has moved
  /// since the frame before; nothing where nobody knows.
  std::optional<Eigen::Vector2d> place_in_depth(const SeenLandmark& seen, double time,
                                                double depth_time) const;

  Camera camera_;
  double level_scale_;
  std::vector<SightedFrame> frames_;
  double last_time_ = 0.0;                            // seconds, of the frame before
  std::unordered_map<int, Eigen::Vector2d> last_at_;  // its landmarks' raw pixels
};

}  // namespace dkp_slam

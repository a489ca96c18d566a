#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/dynamics/compensation/box_tracker.h"
#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/dynamics/masks/clustering.h"
#include "dkp_slam/dynamics/masks/room_planes.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/dynamics/removal/epipolar.h"
#include "dkp_slam/dynamics/removal/regions.h"
#include "dkp_slam/dynamics/removal/removal.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

struct DynamicsOptions {
  DynamicsMode mode = DynamicsMode::dkp_plus;
  ClusteringOptions clustering;
  RoomPlanesOptions room;
  BoxTrackerOptions compensation;
  FeatureMotionOptions motion;
  EpipolarOptions epipolar;
  RegionOptions regions;
  RemovalOptions removal;
  std::uint64_t seed = 1;
};

/// The paper's own part, §3.3 to §3.5: objects, their masks, and which features are static.
/// Called with every frame in order, from one thread. Repeats exactly for the same input and seed.
class DynamicsModule {
 public:
  /// Throws `Error` when the camera makes no sense.
  DynamicsModule(const Camera& camera, const DynamicsOptions& options);
  ~DynamicsModule();
  DynamicsModule(DynamicsModule&&) noexcept;
  DynamicsModule& operator=(DynamicsModule&&) noexcept;

  /// `grey` is CV_8UC1 and of the frame's size, `keypoints` are raw (distorted) pixels,
  /// `detections` go down to `BoxTrackerOptions::continue_score`. Throws `Error` when sizes differ.
  FrameDynamics process(const RgbdFrame& frame, const cv::Mat& grey,
                        const std::vector<cv::KeyPoint>& keypoints,
                        const std::vector<Detection>& detections);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dkp_slam

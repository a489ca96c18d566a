#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/dynamics/dynamics_options.h"
#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// The paper's own part, §3.3 to §3.5: objects, their masks, and which features are static. What it
/// does is up to the parts of its mode (parts.h).
/// Called with every frame in order, from one thread. Repeats exactly for the same input and seed.
class DynamicsModule {
 public:
  /// Throws `Error` when the camera makes no sense.
  DynamicsModule(const Camera& camera, const DynamicsOptions& options, std::uint64_t seed = 1);
  ~DynamicsModule();
  DynamicsModule(DynamicsModule&&) noexcept;
  DynamicsModule& operator=(DynamicsModule&&) noexcept;

  /// `grey` is CV_8UC1 and of the frame's size, `keypoints` are raw (distorted) pixels. `answer` is
  /// the newest of the detector, of this frame's image or an earlier one, its detections down to
  /// `ObjectTrackerOptions::continue_score`. Throws `Error` when sizes differ.
  FrameDynamics process(const RgbdFrame& frame, const cv::Mat& grey,
                        const std::vector<cv::KeyPoint>& keypoints, const DetectionResult& answer);

  /// The verdict on features that were added to the frame that was processed last, the keypoints
  /// from `first` on: by the same rule, where the mode has one that looks at features one by one
  /// and what lies outside the boxes tells the camera's motion.
  void judge_added(const RgbdFrame& frame, const std::vector<cv::KeyPoint>& keypoints,
                   std::size_t first, FrameDynamics& dynamics) const;

  /// CV_8UC1, image size: 255 where the frame that was processed last, `grey`, shows a surface that
  /// was seen standing still before. Empty in modes that do not remember any.
  cv::Mat known_static(const cv::Mat& grey) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dkp_slam

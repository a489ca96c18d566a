#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Missed-detection compensation as the paper's §3.3 prints it: where a detection is missing, the
/// features of the frame before are tracked into this one, those that were dynamic are dropped,
/// RANSAC drops the wrong matches, and the pose comes from what is left. Tracked here the other way
/// round, as all flow is: every feature goes back and takes the verdict of the earlier one next to
/// it.
class FlowCompensation {
 public:
  explicit FlowCompensation(const MotionOptions& options) : options_(options) {}

  /// What the frame that follows will go by: features (raw pixels) and which of them were static.
  void remember(std::vector<cv::Point2f> points, std::vector<std::uint8_t> is_static);

  struct Result {
    std::vector<std::uint8_t> is_static;  ///< 1 for inliers that were not dynamic before
    std::optional<Se3> current_from_previous;
  };
  /// For a frame in which a detection is missing. `depth` (CV_32FC1, metres) and `points` of this
  /// frame, `motion` their flow; measures the ego-motion with `estimator`.
  Result compensate(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                    std::uint64_t seed, FeatureMotionEstimator& estimator,
                    FeatureMotion& motion) const;

 private:
  bool was_static(const cv::Point2f& pixel) const;

  MotionOptions options_;
  std::vector<cv::Point2f> points_;
  std::vector<std::uint8_t> was_static_;
};

}  // namespace dkp_slam

#include "dkp_slam/dynamics/compensation/flow_compensation.h"

#include <limits>

namespace dkp_slam {

void FlowCompensation::remember(std::vector<cv::Point2f> points,
                                std::vector<std::uint8_t> is_static) {
  points_ = std::move(points);
  was_static_ = std::move(is_static);
}

/// Of the earlier feature nearest to the pixel; true while there was none.
bool FlowCompensation::was_static(const cv::Point2f& pixel) const {
  float nearest = std::numeric_limits<float>::infinity();
  bool verdict = true;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const cv::Point2f d = points_[i] - pixel;
    if (d.dot(d) >= nearest) continue;
    nearest = d.dot(d);
    verdict = was_static_[i] != 0;
  }
  return verdict;
}

FlowCompensation::Result FlowCompensation::compensate(const cv::Mat& depth,
                                                      const std::vector<cv::Point2f>& points,
                                                      std::uint64_t seed,
                                                      FeatureMotionEstimator& estimator,
                                                      FeatureMotion& motion) const {
  Result result;
  result.is_static.assign(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool tracked = motion.tracks.tracked[i] != 0;
    result.is_static[i] = tracked && was_static(motion.tracks.previous[i]) ? 1 : 0;
  }
  estimator.measure_ego_motion(depth, points, result.is_static, seed, motion);
  if (!motion.camera_motion) return result;
  result.current_from_previous = motion.camera_motion->previous_from_current.inverse();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (static_cast<double>(motion.residual[i]) > options_.inlier_distance) result.is_static[i] = 0;
  }
  return result;
}

}  // namespace dkp_slam

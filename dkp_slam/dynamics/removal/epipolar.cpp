#include "dkp_slam/dynamics/removal/epipolar.h"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>

namespace dkp_slam {

std::optional<cv::Matx33d> estimate_fundamental(const PointMatches& matches,
                                                const EpipolarOptions& options) {
  const auto low_count = std::count(matches.low.begin(), matches.low.end(), std::uint8_t{1});
  const bool all = low_count < options.min_low_matches;
  std::vector<cv::Point2f> previous, current;
  for (std::size_t i = 0; i < matches.current.size(); ++i) {
    if (!all && matches.low[i] == 0) continue;
    previous.push_back(matches.previous[i]);
    current.push_back(matches.current[i]);
  }
  constexpr std::size_t min_matches = 15;  // a 7-point sample and as many again to confirm it
  if (previous.size() < min_matches) return std::nullopt;
  std::vector<std::uint8_t> inlier;
  const cv::Mat sample_model =
      cv::findFundamentalMat(previous, current, cv::FM_RANSAC, options.inlier_distance,
                             options.confidence, options.max_iterations, inlier);
  if (sample_model.rows != 3 || sample_model.cols != 3) return std::nullopt;
  std::vector<cv::Point2f> inlier_previous, inlier_current;
  for (std::size_t i = 0; i < previous.size(); ++i) {
    if (inlier[i] == 0) continue;
    inlier_previous.push_back(previous[i]);
    inlier_current.push_back(current[i]);
  }
  if (inlier_previous.size() < min_matches) return cv::Matx33d(sample_model);
  const cv::Mat refined = cv::findFundamentalMat(inlier_previous, inlier_current, cv::FM_8POINT);
  return cv::Matx33d(refined.rows == 3 ? refined : sample_model);
}

double epipolar_distance(const cv::Matx33d& fundamental, const cv::Point2f& previous,
                         const cv::Point2f& current) {
  const cv::Vec3d line = fundamental * cv::Vec3d(previous.x, previous.y, 1.0);
  const double length = std::hypot(line[0], line[1]);
  if (length <= 0.0) return 0.0;
  return std::abs(line.dot(cv::Vec3d(current.x, current.y, 1.0))) / length;
}

}  // namespace dkp_slam

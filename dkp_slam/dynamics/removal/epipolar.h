#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

class OptionList;

struct EpipolarOptions {
  double inlier_distance = 1.0;  ///< pixels, of the 7-point RANSAC
  double confidence = 0.99;
  int max_iterations = 300;
  /// Fewer matches in low regions than this: all matches are used (algorithm.md, §3.5).
  int min_low_matches = 30;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Matched undistorted pixels of the earlier and the current frame.
struct PointMatches {
  std::vector<cv::Point2f> previous;
  std::vector<cv::Point2f> current;
  std::vector<std::uint8_t> low;  ///< 1 where the current point lies in a low region
};

/// F with current' F previous = 0: RANSAC over 7-point samples (Hartley and Zisserman, 11.1.2) of
/// the low-region matches, refined by the 8-point method on its inliers. Nothing when there are too
/// few matches or no model holds. Repeats exactly for the same matches.
std::optional<cv::Matx33d> estimate_fundamental(const PointMatches& matches,
                                                const EpipolarOptions& options);

/// D of Eq. 5: distance, pixels, of the current point from the epipolar line of the previous one.
double epipolar_distance(const cv::Matx33d& fundamental, const cv::Point2f& previous,
                         const cv::Point2f& current);

}  // namespace dkp_slam

#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Depth (CV_32FC1) at a raw pixel, the nearest one of the image: the nearest reading, which does
/// not mix the two sides of an edge.
inline float depth_at(const cv::Mat& depth, const cv::Point2f& pixel) {
  const int u = std::clamp(cvRound(pixel.x), 0, depth.cols - 1);
  const int v = std::clamp(cvRound(pixel.y), 0, depth.rows - 1);
  return depth.at<float>(v, u);
}

}  // namespace dkp_slam

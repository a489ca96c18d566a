#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/nearest_pixel.h"

namespace dkp_slam {

/// Depth (CV_32FC1) at a raw pixel, the nearest one of the image: the nearest reading, which does
/// not mix the two sides of an edge.
inline float depth_at(const cv::Mat& depth, const cv::Point2f& pixel) {
  return depth.at<float>(nearest_pixel(depth.size(), pixel));
}

}  // namespace dkp_slam

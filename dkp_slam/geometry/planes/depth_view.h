#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// One pixel in `DepthView::step` squared of a depth image, with the viewing rays of those pixels.
/// The clustering works on it: a quarter of the pixels, the same outline to one pixel.
struct DepthView {
  static constexpr int step = 2;
  cv::Mat depth;  ///< CV_32FC1, metres, 0 where unknown; pixel (x, y) is (2x, 2y) of the image
  cv::Mat rays;   ///< CV_32FC2, undistorted (x / z, y / z) of each pixel

  Eigen::Vector3f point(int x, int y) const {
    const auto& ray = rays.at<cv::Vec2f>(y, x);
    const float z = depth.at<float>(y, x);
    return {ray[0] * z, ray[1] * z, z};
  }
};

/// Rays of the view's pixels; depends on the camera alone.
cv::Mat depth_view_rays(const Camera& camera);

/// `depth` is CV_32FC1, metres, 0 where unknown.
DepthView make_depth_view(const cv::Mat& depth, const cv::Mat& rays);

}  // namespace dkp_slam

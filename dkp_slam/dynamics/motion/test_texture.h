#pragma once

#include <cmath>

#include <opencv2/core.hpp>

namespace dkp_slam::testing {

constexpr int width = 320, height = 240;

/// A smooth texture, moved by (`right`, `down`) pixels.
inline cv::Mat texture(double right, double down) {
  cv::Mat image(height, width, CV_8UC1);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const double x = u - right, y = v - down;
      const double value = 128 + 40 * std::sin(0.21 * x + 0.08 * y) +
                           35 * std::sin(0.15 * y - 0.11 * x + 1) +
                           30 * std::sin(0.06 * x * y / 40);
      image.at<uchar>(v, u) = cv::saturate_cast<uchar>(value);
    }
  }
  return image;
}

}  // namespace dkp_slam::testing

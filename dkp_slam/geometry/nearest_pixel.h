#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// The pixel of an image that is nearest to a raw one, which may lie just outside it.
inline cv::Point nearest_pixel(const cv::Size& image, const cv::Point2f& pixel) {
  return {std::clamp(cvRound(pixel.x), 0, image.width - 1),
          std::clamp(cvRound(pixel.y), 0, image.height - 1)};
}

}  // namespace dkp_slam

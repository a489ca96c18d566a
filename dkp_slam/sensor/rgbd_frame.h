#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

/// One colour image with the depth image that belongs to it, registered to it.
struct RgbdFrame {
  int index = 0;           ///< position in the source, from 0
  double timestamp = 0.0;  ///< seconds, the sensor's clock, of the colour image
  cv::Mat colour;          ///< CV_8UC3, BGR, as the lens gives it (distorted)
  cv::Mat depth;           ///< CV_32FC1, metres, 0 where unknown; same size as colour
};

}  // namespace dkp_slam

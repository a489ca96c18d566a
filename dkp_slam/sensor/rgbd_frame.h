#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

/// One colour image with the depth image that belongs to it, registered to it.
struct RgbdFrame {
  int index = 0;           ///< position in the source, from 0
  double timestamp = 0.0;  ///< seconds, the sensor's clock, of the colour image
  /// Seconds from the colour image to the depth image; negative when depth was taken first. The
  /// TUM recordings' cameras run freely, up to 20 ms apart.
  double depth_delay = 0.0;
  double decode_ms = 0.0;  ///< that reading and decoding took, where somebody measured it
  cv::Mat colour;          ///< CV_8UC3, BGR, as the lens gives it (distorted)
  cv::Mat depth;           ///< CV_32FC1, metres, 0 where unknown; same size as colour
  /// As `depth`: the image that the time stamps alone give this colour image, where the camera's
  /// known delay made `depth` another; empty where it did not. For what moves it may be the right
  /// one (MaskDepthChoice).
  cv::Mat stamped_depth;
  /// CV_8UC1, same size as colour: 0 on what is static, anything else on what moves, as somebody
  /// else's segmentation says (DynamicsMode::masks). Empty: nobody said, which is not the same as
  /// nobody there.
  cv::Mat mask;
};

}  // namespace dkp_slam

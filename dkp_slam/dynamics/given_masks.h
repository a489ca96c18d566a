#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/flow.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// The masks that come with the images (RgbdFrame::mask), and what becomes of the last one in
/// images that come without: its pieces go on with the flow of the features on them.
class GivenMasks {
 public:
  /// A mask is carried on for so many seconds at most.
  explicit GivenMasks(double carry_seconds) : carry_seconds_(carry_seconds) {}

  /// CV_8UC1, image size: i + 1 in the i-th connected piece of the mask (the last label is that of
  /// all pieces beyond), 0 on what is static and where nobody said. `points` are the frame's
  /// features, raw pixels, `tracks` their flow into the frame before. Once a frame, in order.
  cv::Mat labels(const RgbdFrame& frame, const std::vector<cv::Point2f>& points,
                 const FlowResult& tracks);

 private:
  cv::Mat carried(const std::vector<cv::Point2f>& points, const FlowResult& tracks) const;

  double carry_seconds_;
  cv::Mat labels_;      // of the frame before; empty before the first mask
  double given_ = 0.0;  // when the last mask came, seconds
};

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/sensor/rgbd_frame.h"
#include "python/src/arrays.h"

namespace dkp_slam::python {

/// dkp_slam.Frame: images as the system has them.
struct FrameObject {
  RgbdFrame frame;
};

/// A new array of the same pixels in the other order.
py::array rgb_of(const cv::Mat& bgr);

}  // namespace dkp_slam::python

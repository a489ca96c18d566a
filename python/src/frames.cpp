#include "python/src/frames.h"

#include <opencv2/imgproc.hpp>

namespace dkp_slam::python {

py::array rgb_of(const cv::Mat& bgr) {
  cv::Mat rgb;
  {
    const py::gil_scoped_release release;
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  }
  return array_of(rgb, true);
}

}  // namespace dkp_slam::python

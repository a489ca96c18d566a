#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Where a camera with a global shutter would have seen points at the moment of the image's middle
/// row. A rolling shutter reads row after row: at a turn of 1 rad/s the first and the last row of a
/// Kinect's colour image are 10 px apart (Ringaby and Forssén 2011, "Scan Rectification for
/// Structured Light Range Sensors with Rolling Shutters").
///
/// `pixel`: undistorted, as seen; `raw_row`: v of the raw pixel, which fixes the moment; `depth`:
/// metres, 0 where unknown (then far); `velocity`: tangent (translation, rotation) per second of
/// the motion from the camera at one moment to the camera at a later one.
cv::Point2f at_middle_row(const Camera& camera, const cv::Point2f& pixel, float raw_row,
                          float depth, const Vector6d& velocity);

/// Moment of a raw row after the middle row's, seconds.
inline double row_delay(const Camera& camera, double raw_row) {
  return (raw_row / camera.height - 0.5) * camera.readout;
}

}  // namespace dkp_slam

#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A point in an image: undistorted pixel, and its depth in metres, 0 where unknown.
struct ImagePoint {
  cv::Point2f pixel;
  float depth = 0.0F;
};

/// Where a camera with a global shutter would have seen a point at the moment of the image's middle
/// row, and how deep. A rolling shutter reads row after row: at a turn of 1 rad/s the first and the
/// last row of a Kinect's colour image are 10 px apart (Ringaby and Forssén 2011, "Scan
/// Rectification for Structured Light Range Sensors with Rolling Shutters").
///
/// `seen`: as seen, its depth at the moment of the depth image's row (Camera::depth_readout);
/// unknown depth is taken as far, and stays unknown.
/// `raw_row`: v of the raw pixel, which fixes the moment; `velocity`: tangent (translation,
/// rotation) per second of the motion from the camera at one moment to the camera at a later one.
ImagePoint at_middle_row(const Camera& camera, const ImagePoint& seen, float raw_row,
                         const Vector6d& velocity);

/// Moment of a raw row after the middle row's, seconds.
inline double row_delay(const Camera& camera, double raw_row) {
  return (raw_row / camera.height - 0.5) * camera.readout;
}
/// The same of the depth image.
inline double depth_row_delay(const Camera& camera, double raw_row) {
  return (raw_row / camera.height - 0.5) * camera.readout_of_depth();
}

}  // namespace dkp_slam

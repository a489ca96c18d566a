#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A depth image around one of its pixels, as a plane. On a flat surface the inverse of the depth
/// is linear in the pixel, so that it is known at neighbouring pixels, too: where the feature was
/// when the depth image was taken.
struct DepthPatch {
  Eigen::Vector2d pixel{0.0, 0.0};  ///< raw, at which it was fitted
  double inverse = 0.0;             ///< 1/metre at that pixel; 0: no plane there, nothing known
  Eigen::Vector2d slope{0.0, 0.0};  ///< 1/(metre pixel)

  bool known() const { return inverse > 0.0; }
};

/// Fits a patch to a depth image (CV_32FC1, metres, 0 unknown). Unknown where too many pixels are,
/// at edges, and where the surface is not flat within the sensor's noise.
DepthPatch fit_depth_patch(const cv::Mat& depth, const Camera& camera,
                           const Eigen::Vector2d& pixel);

/// A landmark seen in a frame.
struct SeenLandmark {
  int landmark = 0;
  Eigen::Vector2d pixel;  ///< raw
  double sigma = 1.0;     ///< pixels, relative to the other sightings
  DepthPatch depth;
};

/// A frame as the calibration takes it.
struct SightedFrame {
  double time = 0.0;        ///< seconds, of the middle row
  double depth_time = 0.0;  ///< seconds, of the depth image's, as far as it is known
  Se3 world_from_camera;    ///< at `time`, as far as it is known
  std::vector<SeenLandmark> sightings;
};

}  // namespace dkp_slam

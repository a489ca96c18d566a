#pragma once

#include <array>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

class OptionList;

/// What a keyframe or frame measured of one landmark.
struct Observation {
  Eigen::Vector2d pixel;     ///< undistorted
  double depth = 0.0;        ///< metres; 0 when unknown
  double pixel_sigma = 1.0;  ///< pixels, of each coordinate
};

/// How observations are weighted; the same in pose-only and bundle adjustment.
struct MeasurementModel {
  /// Pixel noise of a corner on pyramid level 0; it grows with the level's scale. One pixel is
  /// ORB-SLAM's assumption.
  double pixel_sigma = 1.0;
  /// The depth noise formula of the camera, times this: the formula is the noise of one reading of
  /// a plane; corners sit at edges, and registration, lens and calibration errors do not average
  /// out.
  double depth_sigma_factor = 5.0;
  /// Robust thresholds: 95% of the chi-square distribution, 2 and 1 degrees of freedom.
  double pixel_chi2 = 5.991;
  double depth_chi2 = 3.841;

  double depth_sigma(const Camera& camera, double depth) const {
    return depth_sigma_factor * camera.depth_noise.sigma(depth);
  }

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

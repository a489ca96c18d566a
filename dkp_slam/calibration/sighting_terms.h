#pragma once

#include <optional>

#include "dkp_slam/calibration/motion_spline.h"
#include "dkp_slam/calibration/parameters.h"
#include "dkp_slam/calibration/sightings.h"

namespace dkp_slam {

/// A landmark seen at a moment, ready to be compared with a motion.
struct TimedSighting {
  double time = 0.0, depth_time = 0.0;  ///< seconds, of the middle row
  double row = 0.0;                     ///< -1/2 at the first row, 1/2 at the last
  Eigen::Vector2d pixel;                ///< raw
  double sigma = 1.0;                   ///< pixels, relative to the other sightings
  DepthPatch depth;
  /// Seconds, of its row in the depth image after the middle one's, where the camera's
  /// `depth_readout` is known; nothing: as in the colour image.
  std::optional<double> depth_row_delay;
  DepthDistortion::Terms depth_terms = DepthDistortion::Terms::Zero();  ///< at the patch's pixel
};

/// An error and its derivatives.
template <int Rows>
struct ErrorTerm {
  bool valid = false;  ///< the point lies before the camera
  Eigen::Matrix<double, Rows, 1> error;
  MotionSpline::Moment moment;              ///< at which the spline is touched
  Eigen::Matrix<double, Rows, 6> by_pose;   ///< rotation vector, position at the moment
  Eigen::Matrix<double, Rows, 3> by_point;  ///< of the landmark
  Eigen::Matrix<double, Rows, 1> by_time;   ///< of the camera alone: per second
  Eigen::Matrix<double, Rows, parameter_count> by_parameter;
};

/// Pixels between where the landmark must appear and where it was seen. `lens`: whether the
/// derivatives by the lens are wanted; they take time.
ErrorTerm<2> pixel_error(const MotionSpline& motion, const Eigen::Vector3d& point,
                         const TimedSighting& seen, const Parameters& parameters, bool lens);

/// 1/metre, of the inverse depth: the landmark's less the depth image's where it must appear then.
ErrorTerm<1> depth_error(const MotionSpline& motion, const Eigen::Vector3d& point,
                         const TimedSighting& seen, const Parameters& parameters, bool lens);

}  // namespace dkp_slam

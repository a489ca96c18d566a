#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

struct MotionOptions {
  int iterations = 100;            ///< three-point samples
  int max_scored = 300;            ///< points a sample is scored on
  double inlier_distance = 2.0;    ///< pixels: LK's noise plus the depth's at short range
  int min_points = 12;             ///< fewer say nothing about six unknowns
  double min_inlier_share = 0.35;  ///< of the points: below it the motion is not believed
  /// How fast a hand changes a camera's speed, sigma, m/s^2 and rad/s^2: twice what the motion
  /// capture of the benchmark's sequences shows. Few points in a corner of the image cannot tell a
  /// turn from a shift; this can.
  double acceleration = 3.0;
  double angular_acceleration = 12.0;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A point of the current frame and where flow found it in an earlier one.
struct MotionPoint {
  Eigen::Vector3d point =
      Eigen::Vector3d::Zero();  ///< current camera frame, metres, from the current depth
  Eigen::Vector2d previous = Eigen::Vector2d::Zero();  ///< undistorted pixel in the earlier frame
};

struct CameraMotion {
  Se3 previous_from_current;
  int inliers = 0;
  double noise = 0.0;  ///< robust standard deviation of the inliers' residuals per axis, pixels
  /// Of the left tangent (metres, radians), each point's sigma taken for one pixel per axis.
  Matrix6d covariance = Matrix6d::Zero();
};

/// What is known of a camera's motion before it is measured. Unless told otherwise, nothing.
struct ExpectedMotion {
  Se3 previous_from_current;
  double translation_sigma = std::numeric_limits<double>::infinity();  ///< metres, per axis
  double rotation_sigma = std::numeric_limits<double>::infinity();     ///< radians, per axis
};

/// Camera motion between two frames by RANSAC over three-point samples and robust least squares
/// on the reprojection error in the earlier frame, one pixel being its sigma, and on the distance
/// from the expected motion, which starts every solution too: motions between frames are small.
/// Nothing when too few points agree. The same seed gives the same motion.
std::optional<CameraMotion> estimate_motion(const Camera& camera,
                                            const std::vector<MotionPoint>& points,
                                            const ExpectedMotion& expected,
                                            const MotionOptions& options, std::uint64_t seed);

/// The same without the search: robust least squares from `start` on.
std::optional<CameraMotion> refine_motion(const Camera& camera,
                                          const std::vector<MotionPoint>& points,
                                          const ExpectedMotion& expected, const Se3& start,
                                          const MotionOptions& options);

/// Sigma per axis, pixels, of where the motion takes a static point (current camera frame, metres)
/// in the earlier frame, by its covariance: small among the points that told the motion, large far
/// from them. 0 when that lies behind the camera.
double prediction_sigma(const Camera& camera, const CameraMotion& motion,
                        const Eigen::Vector3d& point);

/// Distance, pixels, between where flow found the point and where a static point would have been.
/// NaN when that lies behind the camera.
double motion_residual(const Camera& camera, const Se3& previous_from_current,
                       const MotionPoint& point);

/// The same for a point whose depth lies somewhere in [near, far] metres (far may be infinite),
/// seen at an undistorted `current` pixel: distance to the stretch of its epipolar line that those
/// depths can reach.
double motion_residual_between(const Camera& camera, const Se3& previous_from_current,
                               const Eigen::Vector2d& current, const Eigen::Vector2d& previous,
                               double near, double far);

}  // namespace dkp_slam

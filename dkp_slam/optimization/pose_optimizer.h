#pragma once

#include <vector>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// A landmark taken as known, and where the frame saw it.
struct PoseObservation {
  Eigen::Vector3d landmark;  ///< world frame, metres
  Observation seen;
};

struct PoseEstimate {
  Se3 camera_from_world;
  std::vector<char> inlier;  ///< one per observation: pixel error within the chi-square bound
  int inliers = 0;
};

/// Pose-only bundle adjustment ("motion-only BA", Mur-Artal et al. 2015): Gauss-Newton on SE(3)
/// over pixel and depth residuals with Huber's kernel, in rounds that drop and take back outliers.
/// Written by hand rather than with Ceres: six unknowns and a few hundred residuals, three times a
/// frame, where setting up a problem costs more than solving it.
PoseEstimate optimize_pose(const Camera& camera, const MeasurementModel& model, const Se3& initial,
                           const std::vector<PoseObservation>& observations);

/// What these observations tell of the pose (the inverse of its covariance), at the noise that
/// `model` assumes of each and independent of one another: of a small motion of the camera, first
/// translation (metres), then rotation (radians), both along the axes of the camera.
Matrix6d pose_information(const Camera& camera, const MeasurementModel& model,
                          const Se3& camera_from_world,
                          const std::vector<PoseObservation>& observations);

}  // namespace dkp_slam

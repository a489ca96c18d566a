#include "dkp_slam/system/self_check.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Pixels that all landmarks of a view are off together: errors of the map itself, of the lens and
/// of the depth, which no number of landmarks averages out. With 0.5 one frame in 200 of seven
/// generated sequences lies over three sigma, with 0.3 one in 20 (docs/reliability.md).
constexpr double common_pixels = 0.6;
/// What stays however near and many they are, metres and radians: calibration and clocks of a real
/// camera. Chosen on fr1_xyz, whose true path has such errors of its own.
constexpr double least_way = 0.004, least_angle = 0.006;
/// What a motion measured from frame to frame is off, metres and radians a second, once nothing
/// else holds the pose.
constexpr double drift = 0.15;

/// A variance for the position, another for the orientation.
Matrix6d isotropic(double position, double orientation) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(position);
  covariance.diagonal().tail<3>().setConstant(orientation);
  return covariance;
}

}  // namespace

Matrix6d PoseQuality::unknown() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return isotropic(infinity, infinity);
}

double PoseQuality::position_sigma() const {
  const Eigen::Matrix3d position = covariance.topLeftCorner<3, 3>();
  if (!position.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(position, Eigen::EigenvaluesOnly);
  return std::sqrt(axes.eigenvalues().maxCoeff());
}

PoseQuality SelfCheck::check(const Frame& frame, bool localised, int tracked,
                             const FrameDynamics& dynamics) {
  PoseQuality quality;
  if (!dynamics.mask.empty()) {
    quality.people_share =
        cv::countNonZero(dynamics.mask) / static_cast<double>(dynamics.mask.total());
  }
  if (localised && tracked > 0) {
    map_seen_ = frame.timestamp;
    last_ = covariance(frame);
  }
  quality.since_map_seen = frame.timestamp - map_seen_;
  if (!localised) return quality;
  const double drifted = drift * quality.since_map_seen;
  quality.covariance = last_ + isotropic(drifted * drifted, drifted * drifted);
  return quality;
}

Matrix6d SelfCheck::covariance(const Frame& frame) const {
  std::vector<PoseObservation> observations;
  double distance = 0.0;  // mean, along the optical axis
  for (int i = 0; i < frame.features.size(); ++i) {
    const int l = frame.landmark[static_cast<std::size_t>(i)];
    if (l < 0 || !map_.has_landmark(l)) continue;
    const Eigen::Vector3d& position = map_.landmark(l).position;
    observations.push_back({position, observation_of(frame.features, i, map_, model_)});
    distance += (frame.camera_from_world * position).z();
  }
  if (observations.size() < 3) return PoseQuality::unknown();
  distance /= static_cast<double>(observations.size());
  const Matrix6d information =
      pose_information(map_.camera(), model_, frame.camera_from_world, observations);
  const double angle = common_pixels / map_.camera().fx, way = angle * distance;
  const Matrix6d covariance =
      information.ldlt().solve(Matrix6d::Identity()) +
      isotropic(way * way + least_way * least_way, angle * angle + least_angle * least_angle);
  // Of landmarks on a line without depth some motions cannot be told at all.
  return covariance.allFinite() ? covariance : PoseQuality::unknown();
}

}  // namespace dkp_slam

#include "bench/truth_offset.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "tests/support/honesty.h"

namespace dkp_slam {
namespace {

constexpr double likely_way = 0.03, likely_angle = 0.05;
constexpr int most_milliseconds = 20;
constexpr double degrees_of_freedom = 6.0;

/// Of one clock, by Gauss and Newton over the offset and the world that the path is in.
struct Fit {
  Se3 camera_from_body;
  double cost = std::numeric_limits<double>::infinity();
};

Fit fit(const std::vector<FrameResult>& localised, const Trajectory& truth, double seconds) {
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  constexpr int steps = 10;
  Vector6d prior;
  prior << Eigen::Vector3d::Constant(std::pow(likely_way, -2)),
      Eigen::Vector3d::Constant(std::pow(likely_angle, -2));
  Se3 world = testing::truth_from_world(localised, truth);
  Fit found;
  for (int step = 0; step < steps; ++step) {
    Matrix12d information = Matrix12d::Zero();
    Vector12d gradient = Vector12d::Zero();
    information.bottomRightCorner<6, 6>() = prior.asDiagonal();
    gradient.tail<6>() = prior.asDiagonal() * found.camera_from_body.log();
    found.cost = 0.0;
    for (const FrameResult& f : localised) {
      const Se3 body = f.world_from_camera * found.camera_from_body;
      const Se3 right = testing::pose_at(truth, f.timestamp + seconds);
      const Vector6d off = ((world * body).inverse() * right).log();
      const Eigen::LDLT<Matrix6d> covariance(f.quality.covariance);
      const double chi2 = off.dot(covariance.solve(off)) / degrees_of_freedom;
      found.cost += std::log1p(chi2);
      Eigen::Matrix<double, 6, 12> jacobian;  // of `off`, by motions of the world and of the body
      jacobian << -adjoint(body.inverse()), -Matrix6d::Identity();
      const Eigen::Matrix<double, 12, 6> weighted =
          jacobian.transpose() * covariance.solve(Matrix6d::Identity()) / (1.0 + chi2);
      information += weighted * jacobian;
      gradient += weighted * off;
    }
    const Vector12d move = -information.ldlt().solve(gradient);
    world = world * Se3::exp(move.head<6>());
    found.camera_from_body = found.camera_from_body * Se3::exp(move.tail<6>());
  }
  return found;
}

}  // namespace

TruthOffset truth_offset(const std::vector<FrameResult>& frames, const Trajectory& truth) {
  const std::vector<FrameResult> localised = testing::localised_of(frames);
  TruthOffset best;
  double cost = std::numeric_limits<double>::infinity();
  for (int milliseconds = -most_milliseconds; milliseconds <= most_milliseconds; ++milliseconds) {
    const double seconds = 1e-3 * milliseconds;
    const Fit found = fit(localised, truth, seconds);
    if (found.cost >= cost) continue;
    cost = found.cost;
    best = {found.camera_from_body, seconds};
  }
  return best;
}

Trajectory without_offset(const Trajectory& truth, const TruthOffset& offset) {
  Trajectory camera;
  for (const StampedPose& pose : truth) {
    camera.push_back({pose.timestamp - offset.seconds,
                      pose.world_from_camera * offset.camera_from_body.inverse()});
  }
  return camera;
}

}  // namespace dkp_slam

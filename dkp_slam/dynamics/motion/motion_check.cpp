#include "dkp_slam/dynamics/motion/motion_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>

#include <Eigen/Cholesky>

#include "dkp_slam/geometry/ransac.h"

namespace dkp_slam {
namespace {

constexpr double min_z = 0.05;  // metres: nearer than any sensor reads

/// Information, one over the sigmas squared, of what is expected: (translation, rotation).
Vector6d information(const ExpectedMotion& expected) {
  Vector6d diagonal;
  diagonal.head<3>().setConstant(1.0 / (expected.translation_sigma * expected.translation_sigma));
  diagonal.tail<3>().setConstant(1.0 / (expected.rotation_sigma * expected.rotation_sigma));
  return diagonal;
}

/// Left tangent from the expected motion to this one.
Vector6d off(const ExpectedMotion& expected, const Se3& motion) {
  return (motion * expected.previous_from_current.inverse()).log();
}

/// Of a point's pixel (u, v) by the left tangent of the motion that brought it to `q`.
struct PixelJacobian {
  Vector6d u, v;
};

PixelJacobian pixel_jacobian(const Camera& camera, const Eigen::Vector3d& q) {
  const double iz = 1.0 / q.z();
  const double a = camera.fx * iz, b = -camera.fx * q.x() * iz * iz;
  const double c = camera.fy * iz, d = -camera.fy * q.y() * iz * iz;
  // Left update exp(delta) * motion: d q / d delta = [I, -skew(q)].
  PixelJacobian j;
  j.u << a, 0.0, b, b * q.y(), a * q.z() - b * q.x(), -a * q.y();
  j.v << 0.0, c, d, -c * q.z() + d * q.y(), -d * q.x(), c * q.x();
  return j;
}

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/// Of weighted reprojection errors and of what is expected; weight of a residual by Tukey's
/// biweight with the given cut (pixels), 1 for an infinite one.
NormalEquations normal_equations(const Camera& camera, std::span<const MotionPoint* const> points,
                                 double cut, const ExpectedMotion& expected, const Se3& motion) {
  NormalEquations sum;
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  for (const MotionPoint* p : points) {
    const Eigen::Vector3d q = rotation * p->point + motion.translation;
    if (q.z() < min_z) continue;
    const Eigen::Vector2d error = camera.project(q) - p->previous;
    double weight = 1.0;
    if (std::isfinite(cut)) {
      const double r = error.squaredNorm() / (cut * cut);
      if (r >= 1.0) continue;
      weight = (1.0 - r) * (1.0 - r);
    }
    const auto [u, v] = pixel_jacobian(camera, q);
    sum.hessian.noalias() += weight * (u * u.transpose() + v * v.transpose());
    sum.gradient.noalias() += weight * (u * error.x() + v * error.y());
  }
  sum.hessian.diagonal() += information(expected);
  sum.gradient += information(expected).cwiseProduct(off(expected, motion));
  sum.hessian.diagonal().array() += 1e-9;
  return sum;
}

/// One Gauss-Newton step; false when the points do not fix the motion.
bool gauss_newton_step(const Camera& camera, std::span<const MotionPoint* const> points, double cut,
                       const ExpectedMotion& expected, Se3& motion) {
  const NormalEquations sum = normal_equations(camera, points, cut, expected, motion);
  const Eigen::LDLT<Matrix6d> solver(sum.hessian);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return false;
  const Vector6d step = -solver.solve(sum.gradient);
  constexpr double wild = 1.0;  // metre or radian: not between two frames
  if (!step.allFinite() || step.norm() > wild) return false;
  motion = Se3::exp(step) * motion;
  return true;
}

double squared_residual(const Camera& camera, const Eigen::Matrix3d& rotation,
                        const Eigen::Vector3d& translation, const MotionPoint& point) {
  const Eigen::Vector3d q = rotation * point.point + translation;
  if (q.z() < min_z) return std::numeric_limits<double>::infinity();
  return (camera.project(q) - point.previous).squaredNorm();
}

/// Truncated squared error over the scored points (MSAC: Torr and Zisserman 2000), and that of what
/// is expected.
double truncated_cost(const Camera& camera, const Se3& motion,
                      std::span<const MotionPoint* const> points, const ExpectedMotion& expected,
                      double limit, double best) {
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  double cost = information(expected).dot(off(expected, motion).cwiseAbs2());
  for (const MotionPoint* p : points) {
    cost += std::min(limit, squared_residual(camera, rotation, motion.translation, *p));
    if (cost >= best) break;
  }
  return cost;
}

/// The camera's motion that most points agree with, for `ransac`; score: the cost, negative.
class MotionSearch {
 public:
  MotionSearch(const Camera& camera, const std::vector<MotionPoint>& points,
               const ExpectedMotion& expected, const MotionOptions& options, std::uint64_t seed)
      : camera_(camera),
        points_(points),
        expected_(expected),
        limit_(options.inlier_distance * options.inlier_distance),
        random_(seed) {
    // A fixed stride spreads the scored points as the features are spread.
    const std::size_t stride =
        1 + (points.size() - 1) / static_cast<std::size_t>(std::max(1, options.max_scored));
    for (std::size_t i = 0; i < points.size(); i += stride) scored_.push_back(&points[i]);
  }

  std::optional<Se3> sample() {
    std::array<const MotionPoint*, 3> three{};
    for (auto& s : three) s = &points_[random_() % points_.size()];
    if (three[0] == three[1] || three[0] == three[2] || three[1] == three[2]) return std::nullopt;
    Se3 motion = expected_.previous_from_current;
    constexpr int steps = 3;  // from a motion that is nearly right already
    for (int s = 0; s < steps; ++s) {
      if (!gauss_newton_step(camera_, three, std::numeric_limits<double>::infinity(), expected_,
                             motion)) {
        return std::nullopt;
      }
    }
    return motion;
  }

  double score(const Se3& motion, double best) const {
    return -truncated_cost(camera_, motion, scored_, expected_, limit_, -best);
  }

 private:
  const Camera& camera_;
  const std::vector<MotionPoint>& points_;
  const ExpectedMotion& expected_;
  const double limit_;
  std::mt19937_64 random_;
  std::vector<const MotionPoint*> scored_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<CameraMotion> refine_motion(const Camera& camera,
                                          const std::vector<MotionPoint>& points,
                                          const ExpectedMotion& expected, const Se3& start,
                                          const MotionOptions& options) {
  std::vector<const MotionPoint*> all;
  for (const MotionPoint& p : points) all.push_back(&p);
  Se3 best = start;
  // Tukey's cut narrows from twice the inlier distance to it.
  for (const double cut : {2.0, 1.5, 1.0, 1.0, 1.0}) {
    if (!gauss_newton_step(camera, all, cut * options.inlier_distance, expected, best)) {
      return std::nullopt;
    }
  }
  CameraMotion result;
  result.previous_from_current = best;
  const double limit = options.inlier_distance * options.inlier_distance;
  const Eigen::Matrix3d rotation = best.rotation.toRotationMatrix();
  std::vector<double> errors;
  for (const MotionPoint* p : all) {
    const double e = squared_residual(camera, rotation, best.translation, *p);
    if (e < limit) errors.push_back(std::sqrt(e));
  }
  result.inliers = static_cast<int>(errors.size());
  if (result.inliers < options.min_points ||
      result.inliers < options.min_inlier_share * static_cast<double>(all.size())) {
    return std::nullopt;
  }
  constexpr double rayleigh_median = 1.1774;  // of a residual's length over its sigma per axis
  result.noise = median(errors) / rayleigh_median;
  result.covariance = normal_equations(camera, all, options.inlier_distance, expected, best)
                          .hessian.ldlt()
                          .solve(Matrix6d::Identity());
  return result;
}

std::optional<CameraMotion> estimate_motion(const Camera& camera,
                                            const std::vector<MotionPoint>& points,
                                            const ExpectedMotion& expected,
                                            const MotionOptions& options, std::uint64_t seed) {
  if (static_cast<int>(points.size()) < options.min_points) return std::nullopt;
  MotionSearch search(camera, points, expected, options, seed);
  const Se3& guess = expected.previous_from_current;
  const double of_guess = search.score(guess, -std::numeric_limits<double>::infinity());
  const Se3 best = *ransac<Se3>(search, options.iterations, of_guess, std::optional(guess)).model;
  return refine_motion(camera, points, expected, best, options);
}

double prediction_sigma(const Camera& camera, const CameraMotion& motion,
                        const Eigen::Vector3d& point) {
  const Eigen::Vector3d q = motion.previous_from_current * point;
  if (q.z() < min_z) return 0.0;
  const auto [u, v] = pixel_jacobian(camera, q);
  return std::sqrt(0.5 * (u.dot(motion.covariance * u) + v.dot(motion.covariance * v)));
}

double motion_residual(const Camera& camera, const Se3& previous_from_current,
                       const MotionPoint& point) {
  const Eigen::Vector3d q = previous_from_current * point.point;
  if (q.z() < min_z) return std::numeric_limits<double>::quiet_NaN();
  return (camera.project(q) - point.previous).norm();
}

double motion_residual_between(const Camera& camera, const Se3& previous_from_current,
                               const Eigen::Vector2d& current, const Eigen::Vector2d& previous,
                               double near, double far) {
  const Eigen::Vector3d turned = previous_from_current.rotation * camera.unproject(current, 1.0);
  const Eigen::Vector3d& moved = previous_from_current.translation;
  // Homogeneous in depth, so that far may be infinite.
  const Eigen::Vector3d near_point = turned + moved / near;
  const Eigen::Vector3d far_point = turned + moved / far;
  if (near_point.z() * near < min_z || far_point.z() <= 0.0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Eigen::Vector2d far_end = camera.project(far_point);
  const Eigen::Vector2d along = camera.project(near_point) - far_end;
  const double length2 = along.squaredNorm();
  const double t =
      length2 > 0.0 ? std::clamp((previous - far_end).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (previous - far_end - t * along).norm();
}

}  // namespace dkp_slam

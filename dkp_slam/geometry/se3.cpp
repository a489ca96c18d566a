#include "dkp_slam/geometry/se3.h"

#include <cmath>

namespace dkp_slam {
namespace {

// Below this angle (radians) the closed forms lose digits and the Taylor series is exact to 1e-16.
constexpr double small_angle = 1e-4;

/// Left Jacobian of SO(3): maps the translation part of the tangent to the translation.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d w = skew(omega);
  if (angle < small_angle) {
    return Eigen::Matrix3d::Identity() + 0.5 * w + w * w / 6.0;
  }
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / a2 * w +
         (angle - std::sin(angle)) / (a2 * angle) * w * w;
}

Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const double k = angle < small_angle ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), k * omega.x(), k * omega.y(), k * omega.z())
      .normalized();
}

Eigen::Vector3d log_rotation(const Eigen::Quaterniond& rotation) {
  // One of the two quaternions of a rotation turns by at most pi.
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double sine = v.norm();
  const double half = std::atan2(sine, sign * rotation.w());
  return sine < small_angle ? Eigen::Vector3d((2.0 + sine * sine / 3.0) * v)
                            : Eigen::Vector3d(2.0 * half / sine * v);
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Se3 Se3::exp(const Vector6d& tangent) {
  const Eigen::Vector3d omega = tangent.tail<3>();
  return {exp_rotation(omega), left_jacobian(omega) * tangent.head<3>()};
}

Vector6d Se3::log() const {
  const Eigen::Vector3d omega = log_rotation(rotation);
  Vector6d tangent;
  tangent.head<3>() = left_jacobian(omega).inverse() * translation;
  tangent.tail<3>() = omega;
  return tangent;
}

Matrix6d adjoint(const Se3& pose) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  Matrix6d a = Matrix6d::Zero();
  a.topLeftCorner<3, 3>() = a.bottomRightCorner<3, 3>() = r;
  a.topRightCorner<3, 3>() = skew(pose.translation) * r;
  return a;
}

Matrix6d lie_bracket(const Vector6d& tangent) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = skew(tangent.tail<3>());
  ad.topRightCorner<3, 3>() = skew(tangent.head<3>());
  return ad;
}

Matrix6d inverse_left_jacobian(const Vector6d& tangent) {
  const Matrix6d ad = lie_bracket(tangent);
  return Matrix6d::Identity() - 0.5 * ad + ad * ad / 12.0;
}

double Se3::angle() const {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

}  // namespace dkp_slam

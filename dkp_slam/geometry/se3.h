#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dkp_slam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rigid transformation. Named `a_from_b` by its users: it maps coordinates in frame b to frame a.
struct Se3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Se3() = default;
  Se3(const Eigen::Quaterniond& r, const Eigen::Vector3d& t) : rotation(r), translation(t) {}

  /// Exponential map of (translation part, rotation part), metres and radians.
  static Se3 exp(const Vector6d& tangent);
  /// Inverse of `exp`.
  Vector6d log() const;

  Se3 inverse() const {
    const Eigen::Quaterniond r = rotation.conjugate();
    return {r, -(r * translation)};
  }
  Se3 operator*(const Se3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  /// Angle of the rotation, radians in [0, pi].
  double angle() const;
};

/// Matrix of the cross product: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Of tangents (translation, rotation): exp(adjoint(T) x) T = T exp(x).
Matrix6d adjoint(const Se3& pose);
/// The same of an infinitesimal motion: lie_bracket(a) * b is the derivative of adjoint(exp(s a)) b
/// by s at 0.
Matrix6d lie_bracket(const Vector6d& tangent);
/// Derivative of log(exp(x) exp(tangent)) by x at 0: the series of the inverse left Jacobian of
/// SE(3) up to the second order (Barfoot 2017, "State Estimation for Robotics", Eq. 7.97); that of
/// log(exp(tangent) exp(x)), the right one, is the same of -tangent.
Matrix6d inverse_left_jacobian(const Vector6d& tangent);

}  // namespace dkp_slam

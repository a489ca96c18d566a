#pragma once

#include <array>

#include <ceres/manifold.h>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Pose block: quaternion (x y z w), translation. Costs give their derivatives by the left
/// perturbation in the first six columns, so the manifold's own Jacobian is the identity's head.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* moved) const override {
    const Se3 pose(Eigen::Quaterniond(x), Eigen::Vector3d(x[4], x[5], x[6]));
    const Se3 next = Se3::exp(Eigen::Map<const Vector6d>(delta)) * pose;
    Eigen::Map<Eigen::Vector4d>{moved} = next.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>{moved + 4} = next.translation;
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* delta) const override {
    const Se3 a(Eigen::Quaterniond(y), Eigen::Vector3d(y[4], y[5], y[6]));
    const Se3 b(Eigen::Quaterniond(x), Eigen::Vector3d(x[4], x[5], x[6]));
    Eigen::Map<Vector6d>{delta} = (a * b.inverse()).log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<6>().setIdentity();
    return true;
  }
};

using PoseBlock = std::array<double, 7>;

inline PoseBlock block_of(const Se3& pose) {
  PoseBlock b;
  Eigen::Map<Eigen::Vector4d>(b.data()) = pose.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d>(b.data() + 4) = pose.translation;
  return b;
}

inline Se3 pose_of(const PoseBlock& b) {
  return {Eigen::Quaterniond(b.data()).normalized(), Eigen::Vector3d(b[4], b[5], b[6])};
}

}  // namespace dkp_slam

#include "dkp_slam/geometry/se3.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(Se3, ExpOfPureTranslationIsThatTranslation) {
  Vector6d tangent;
  tangent << 1.0, -2.0, 3.0, 0.0, 0.0, 0.0;
  const Se3 pose = Se3::exp(tangent);
  EXPECT_TRUE(pose.translation.isApprox(Eigen::Vector3d(1.0, -2.0, 3.0)));
  EXPECT_NEAR(pose.angle(), 0.0, 1e-12);
}

TEST(Se3, QuarterTurnAboutZTakesXToY) {
  Vector6d tangent = Vector6d::Zero();
  tangent[5] = M_PI / 2;
  EXPECT_TRUE(
      (Se3::exp(tangent) * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(Se3, ExpAgreesWithMatrixExponentialSeries) {
  Vector6d tangent;
  tangent << 0.3, -0.2, 0.5, 0.4, -0.7, 0.2;
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() = skew(tangent.tail<3>());
  generator.topRightCorner<3, 1>() = tangent.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int n = 1; n < 30; ++n) {
    term = term * generator / n;
    sum += term;
  }
  const Se3 pose = Se3::exp(tangent);
  EXPECT_TRUE(pose.rotation.toRotationMatrix().isApprox(sum.topLeftCorner<3, 3>(), 1e-12));
  EXPECT_TRUE(pose.translation.isApprox(sum.topRightCorner<3, 1>(), 1e-12));
}

TEST(Se3, LogInvertsExpFromTinyToLargeAngles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (double angle : {0.0, 1e-9, 1e-5, 9e-5, 2e-4, 0.1, 1.0, 3.0}) {
    Vector6d tangent;
    for (int i = 0; i < 6; ++i) tangent[i] = uniform(random);
    tangent.tail<3>() = tangent.tail<3>().normalized() * angle;
    EXPECT_LT((Se3::exp(tangent).log() - tangent).norm(), 1e-9) << "angle " << angle;
  }
}

TEST(Se3, AdjointCarriesATangentOverAPose) {
  Vector6d x, y;
  x << 0.02, -0.03, 0.05, 0.04, 0.01, -0.02;
  y << 1.0, 2.0, -0.5, 0.7, -1.1, 0.4;
  const Se3 pose = Se3::exp(y);
  EXPECT_LT(
      (Se3::exp(adjoint(pose) * x).inverse() * pose * Se3::exp(x) * pose.inverse()).log().norm(),
      1e-12);
  // Of a motion so short that it is its derivative.
  constexpr double short_time = 1e-6;
  EXPECT_LT(((adjoint(Se3::exp(short_time * y)) * x - x) / short_time - lie_bracket(y) * x).norm(),
            1e-5);
}

/// Against differences, for a turn as large as from frame to frame in a hand: 0.1 radians.
TEST(Se3, InverseJacobiansAreTheDerivativesOfTheLogarithm) {
  Vector6d tangent;
  tangent << 0.03, -0.02, 0.05, 0.06, -0.05, 0.07;
  constexpr double h = 1e-6;
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6d x = h * Vector6d::Unit(axis);
    const Vector6d left = ((Se3::exp(x) * Se3::exp(tangent)).log() - tangent) / h;
    const Vector6d right = ((Se3::exp(tangent) * Se3::exp(x)).log() - tangent) / h;
    EXPECT_LT((inverse_left_jacobian(tangent) * Vector6d::Unit(axis) - left).norm(), 1e-5) << axis;
    EXPECT_LT((inverse_left_jacobian(-tangent) * Vector6d::Unit(axis) - right).norm(), 1e-5)
        << axis;
  }
}

TEST(Se3, InverseAndProductUndoEachOther) {
  Vector6d tangent;
  tangent << 0.3, -0.2, 0.5, 0.4, -0.7, 0.2;
  const Se3 a_from_b = Se3::exp(tangent);
  EXPECT_LT((a_from_b * a_from_b.inverse()).log().norm(), 1e-12);
  const Eigen::Vector3d point(1.0, 2.0, 3.0);
  EXPECT_TRUE((a_from_b.inverse() * (a_from_b * point)).isApprox(point, 1e-12));
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/sensor/synthetic/shapes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(SyntheticShapes, RayHitsPanelWhereItsPlaneIs) {
  const Panel panel{{-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, nullptr};
  EXPECT_DOUBLE_EQ(intersect(panel, Vector3d(0, 0, 1)).value(), 2.0);
  EXPECT_DOUBLE_EQ(intersect(panel, Vector3d(0.4, -0.4, 1)).value(), 2.0);
  EXPECT_FALSE(intersect(panel, Vector3d(0.6, 0, 1)));
  EXPECT_FALSE(intersect(panel, Vector3d(0, 0, -1)));
  EXPECT_FALSE(intersect(panel, Vector3d(1, 0, 0)));
  // Plane x + z = 4, seen along (1, 0, 1): at (2, 0, 2).
  const Panel slanted{{1, -1, 3}, {2, 0, -2}, {0, 2, 0}, nullptr};
  EXPECT_DOUBLE_EQ(intersect(slanted, Vector3d(1, 0, 1)).value(), 2.0);
}

TEST(SyntheticShapes, RayHitsEllipsoid) {
  const Solid s = Solid::ellipsoid({0, 0, 5}, Matrix3d::Identity(), {0.5, 1.0, 2.0}, nullptr);
  EXPECT_DOUBLE_EQ(intersect(s, Vector3d(0, 0, 1)).value(), 3.0);
  EXPECT_FALSE(intersect(s, Vector3d(0.2, 0, 1)));
  EXPECT_FALSE(intersect(s, Vector3d(0, 0, -1)));
  // Every hit satisfies the surface's equation.
  for (const double x : {-0.05, 0.0, 0.03}) {
    for (const double y : {-0.10, 0.02, 0.12}) {
      const Vector3d p = intersect(s, Vector3d(x, y, 1)).value() * Vector3d(x, y, 1);
      EXPECT_NEAR((p - s.centre).cwiseQuotient(s.radii).norm(), 1.0, 1e-12);
    }
  }
}

TEST(SyntheticShapes, EveryCapsuleHitIsOneRadiusFromItsAxis) {
  const Vector3d top(0.3, -0.6, 3.0), bottom(-0.2, 0.7, 2.6);
  const double radius = 0.25;
  const Solid s = Solid::capsule(top, bottom, radius, Vector3d::UnitZ(), nullptr);
  int hits = 0;
  for (double x = -0.4; x <= 0.4; x += 0.02) {
    for (double y = -0.5; y <= 0.5; y += 0.02) {
      // Distance of the ray's line from the segment, by brute force.
      const Vector3d direction(x, y, 1);
      double gap = 1e9;
      for (double a = 0.0; a <= 1.0; a += 0.001) {
        const Vector3d c = top + a * (bottom - top);
        gap = std::min(gap, c.cross(direction).norm() / direction.norm());
      }
      const auto t = intersect(s, direction);
      if (std::abs(gap - radius) < 1e-4) continue;
      ASSERT_EQ(t.has_value(), gap < radius) << x << " " << y;
      if (!t) continue;
      ++hits;
      const Vector3d p = *t * direction, axis = bottom - top;
      const double along = std::clamp((p - top).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
      const Vector3d from_axis = p - top - along * axis;
      EXPECT_NEAR(from_axis.norm(), radius, 1e-9);
      EXPECT_LT(from_axis.dot(direction), 1e-9) << "the near side";
      EXPECT_LT((s.normal_at(p) - from_axis / radius).norm(), 1e-9);
    }
  }
  EXPECT_GT(hits, 250);
}

TEST(SyntheticShapes, TextureRunsFromTopToBottomAndMeetsBehind) {
  const Solid s =
      Solid::ellipsoid({1, 2, 3}, Matrix3d::Identity(), Vector3d(0.5, 0.5, 1.0), nullptr);
  EXPECT_LT((s.uv_at({1.5, 2, 3}) - Vector2d(0.5, 0.5)).norm(), 1e-12);
  EXPECT_NEAR(s.uv_at({1, 2, 4}).y(), 0.0, 1e-12);
  EXPECT_NEAR(s.uv_at({1, 2.5, 3}).x(), 0.75, 1e-12);
  EXPECT_NEAR(s.uv_at({0.5, 2.0 + 1e-9, 3}).x(), 1.0, 1e-6);
  EXPECT_NEAR(s.uv_at({0.5, 2.0 - 1e-9, 3}).x(), 0.0, 1e-6);
}

TEST(SyntheticShapes, MovingShapeAndRayTogetherChangesNothing) {
  const Solid s = Solid::capsule({0, 0, 3}, {0.4, 0.2, 3.5}, 0.2, Vector3d::UnitX(), nullptr);
  Vector6d tangent;
  tangent << 0, 0, 0, 0.3, -0.5, 0.8;
  const Se3 turn = Se3::exp(tangent);
  const Vector3d direction(0.05, 0.02, 1);
  EXPECT_NEAR(intersect(turn * s, turn.rotation * direction).value(),
              intersect(s, direction).value(), 1e-12);
}

}  // namespace
}  // namespace dkp_slam

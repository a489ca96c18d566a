#include "dkp_slam/dynamics/motion/motion_check.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "dkp_slam/dynamics/removal/epipolar.h"
#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

Se3 known_motion() {
  Vector6d tangent;
  tangent << 0.03, -0.01, 0.02, 0.01, -0.015, 0.02;
  return Se3::exp(tangent);
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// Points of a static world, and from index `movers_from` on, of something that moved 0.1 m.
std::vector<MotionPoint> observe(std::size_t count, std::size_t movers_from) {
  const Camera camera = testing::vga_camera();
  std::mt19937_64 random(3);
  std::vector<MotionPoint> points;
  while (points.size() < count) {
    const Eigen::Vector2d pixel(uniform(random, 20, 620), uniform(random, 20, 460));
    MotionPoint p;
    p.point = camera.unproject(pixel, uniform(random, 0.8, 4.0));
    Eigen::Vector3d then = p.point;
    if (points.size() >= movers_from) then += Eigen::Vector3d(0.1, 0.0, 0.0);
    p.previous = camera.project(known_motion() * then) +
                 Eigen::Vector2d(uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2));
    points.push_back(p);
  }
  return points;
}

TEST(MotionCheck, FindsTheCameraMotionAmongMovers) {
  const auto points = observe(300, 180);  // 40% move alike
  const auto motion = estimate_motion(testing::vga_camera(), points, {}, {}, 5);
  ASSERT_TRUE(motion.has_value());
  const Se3 error = motion->previous_from_current * known_motion().inverse();
  EXPECT_LT(error.translation.norm(), 0.001);
  EXPECT_LT(error.angle(), 0.0005);
  EXPECT_LT(motion->noise, 0.25);
  int still_right = 0, movers_right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r =
        motion_residual(testing::vga_camera(), motion->previous_from_current, points[i]);
    still_right += i < 180 && r < 1.0 ? 1 : 0;
    movers_right += i >= 180 && r > 5.0 ? 1 : 0;
  }
  EXPECT_EQ(still_right, 180);
  EXPECT_EQ(movers_right, 120);
}

TEST(MotionCheck, SaysHowSureItIsOfWhereAPointGoes) {
  // Points in a corner of the image, whose flow is off by a pixel per axis: over many draws the
  // prediction scatters as it is told to, little among them and much in the corner opposite.
  const Camera camera = testing::vga_camera();
  const Eigen::Vector3d near = camera.unproject({100.0, 380.0}, 1.2);
  const Eigen::Vector3d opposite = camera.unproject({580.0, 60.0}, 2.0);
  std::mt19937_64 random(23);
  std::normal_distribution<double> pixel(0.0, 1.0);
  MotionOptions options;
  options.inlier_distance = 20.0;  // all count, nearly in full
  constexpr int draws = 200;
  double told_near = 0, told_opposite = 0, seen_near = 0, seen_opposite = 0;
  for (int k = 0; k < draws; ++k) {
    std::vector<MotionPoint> points;
    for (int i = 0; i < 60; ++i) {
      MotionPoint p;
      p.point = camera.unproject({uniform(random, 20, 180), uniform(random, 300, 460)},
                                 uniform(random, 0.8, 1.6));
      p.previous =
          camera.project(known_motion() * p.point) + Eigen::Vector2d(pixel(random), pixel(random));
      points.push_back(p);
    }
    const auto motion = refine_motion(camera, points, {}, known_motion(), options);
    ASSERT_TRUE(motion);
    const auto off2 = [&](const Eigen::Vector3d& p) {  // per axis
      return 0.5 * (camera.project(motion->previous_from_current * p) -
                    camera.project(known_motion() * p))
                       .squaredNorm();
    };
    told_near += prediction_sigma(camera, *motion, near) / draws;
    told_opposite += prediction_sigma(camera, *motion, opposite) / draws;
    seen_near += off2(near) / draws;
    seen_opposite += off2(opposite) / draws;
  }
  EXPECT_NEAR(told_near / std::sqrt(seen_near), 1.0, 0.15);
  EXPECT_NEAR(told_opposite / std::sqrt(seen_opposite), 1.0, 0.15);
  EXPECT_GT(told_opposite, 5.0 * told_near);
}

TEST(MotionCheck, SaysNothingWithoutAgreement) {
  EXPECT_FALSE(estimate_motion(testing::vga_camera(), observe(8, 8), {}, {}, 5).has_value());
  std::mt19937_64 random(9);
  auto points = observe(100, 100);
  for (auto& p : points) p.previous = {uniform(random, 0, 640), uniform(random, 0, 480)};
  EXPECT_FALSE(estimate_motion(testing::vga_camera(), points, {}, {}, 5).has_value());
}

TEST(MotionCheck, WhatIsExpectedDecidesWhereFewPointsCannot) {
  // Seventy points in a corner of the image at nearly one depth: a turn and a shift look alike.
  const Camera camera = testing::vga_camera();
  std::mt19937_64 random(11);
  Vector6d turn = Vector6d::Zero();
  turn[4] = -0.06;
  const Se3 truth = Se3::exp(turn);
  std::vector<MotionPoint> points;
  for (int i = 0; i < 70; ++i) {
    MotionPoint p;
    p.point = camera.unproject({uniform(random, 20, 120), uniform(random, 300, 460)},
                               uniform(random, 0.78, 0.82));
    p.previous = camera.project(truth * p.point) +
                 Eigen::Vector2d(uniform(random, -1.5, 1.5), uniform(random, -1.5, 1.5));
    points.push_back(p);
  }
  ExpectedMotion expected;
  expected.previous_from_current = Se3::exp(0.9 * turn);
  const auto shift_of = [&](const ExpectedMotion& e) {
    const auto motion = estimate_motion(camera, points, e, {}, 5);
    EXPECT_TRUE(motion.has_value());
    return motion ? motion->previous_from_current.translation.norm() : 1.0;
  };
  EXPECT_GT(shift_of(expected), 0.01);  // metres, where there was no shift
  expected.translation_sigma = 0.003;
  expected.rotation_sigma = 0.01;
  EXPECT_LT(shift_of(expected), 0.003);
}

TEST(MotionCheck, WithoutDepthOnlyMotionAcrossTheEpipolarLineShows) {
  const Camera camera = testing::vga_camera();
  Se3 sideways;
  sideways.translation = {0.1, 0.0, 0.0};  // previous = current + 0.1 m: 52.5 px / z to the right
  const Eigen::Vector2d now(300.0, 200.0);
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(motion_residual_between(camera, sideways, now, {326.25, 200.0}, 0.5, inf), 0.0, 1e-9);
  EXPECT_NEAR(motion_residual_between(camera, sideways, now, {326.25, 204.0}, 0.5, inf), 4.0, 1e-9);
  EXPECT_NEAR(motion_residual_between(camera, sideways, now, {297.0, 200.0}, 0.5, inf), 3.0, 1e-9);
  // Depth in [1, 2] m: 52.5 to 26.25 px.
  EXPECT_NEAR(motion_residual_between(camera, sideways, now, {355.0, 200.0}, 1.0, 2.0), 2.5, 1e-9);
}

TEST(Epipolar, FindsFFromLowRegionsThoughPeopleAreTheMajority) {
  const Camera camera = testing::vga_camera();
  const auto points = observe(300, 120);  // 60% of the matches move alike
  PointMatches matches;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d now = camera.project(points[i].point);
    matches.current.emplace_back(static_cast<float>(now.x()), static_cast<float>(now.y()));
    matches.previous.emplace_back(static_cast<float>(points[i].previous.x()),
                                  static_cast<float>(points[i].previous.y()));
    matches.low.push_back(i < 120 ? 1 : 0);
  }
  const auto fundamental = estimate_fundamental(matches, {});
  ASSERT_TRUE(fundamental.has_value());
  int still_right = 0, movers_right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = epipolar_distance(*fundamental, matches.previous[i], matches.current[i]);
    still_right += i < 120 && d < 1.0 ? 1 : 0;
    movers_right += i >= 120 && d > 1.0 ? 1 : 0;
  }
  EXPECT_GT(still_right, 114);
  EXPECT_GT(movers_right, 120);  // of 180: motion along the line cannot show
}

}  // namespace
}  // namespace dkp_slam

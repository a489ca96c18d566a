#include "dkp_slam/dynamics/motion/moving_surfaces.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// Two surfaces of a view of 320 x 240 pixels: 1 on the left, 2 on the right.
SegmentMap two_surfaces() {
  SegmentMap map;
  map.labels = cv::Mat::zeros(240, 320, CV_32SC1);
  for (int i = 0; i < 2; ++i) {
    Segment s;
    s.box = cv::Rect(40 + 160 * i, 50, 60, 120);
    s.area = s.box.area();
    s.mean_depth = 2.0F;
    map.labels(s.box) = i + 1;
    map.segments.push_back(s);
  }
  return map;
}

/// Twenty features on each surface with these residuals, pixels.
struct Features {
  std::vector<cv::Point2f> points;
  FeatureMotion motion;
  Features(float left, float right, float long_left = unknown, float long_right = unknown) {
    for (int i = 0; i < 20; ++i) {
      for (int side = 0; side < 2; ++side) {
        points.emplace_back(float(100 + 320 * side), float(110 + 10 * i));
        motion.residual.push_back(side == 0 ? left : right);
        motion.long_residual.push_back(side == 0 ? long_left : long_right);
        motion.prediction_sigma.push_back(0.0F);
      }
    }
  }
};

SegmentMap judged(const MovingSurfaces& surfaces, const Features& f) {
  SegmentMap map = two_surfaces();
  surfaces.judge(f.points, f.motion, map);
  return map;
}

TEST(MovingSurfaces, JudgesByShortAndLongBaseline) {
  const MovingSurfaces surfaces({});
  const SegmentMap fast = judged(surfaces, {3.0F, 0.2F, unknown, 0.3F});
  EXPECT_TRUE(fast.segments[0].proved_moving());
  EXPECT_TRUE(fast.segments[1].proved_still());
  const SegmentMap slow = judged(surfaces, {0.5F, 0.5F, 3.0F, 2.0F});
  EXPECT_TRUE(slow.segments[0].proved_moving());
  EXPECT_FALSE(slow.segments[1].proved_moving());  // between the thresholds: says nothing
  EXPECT_FALSE(slow.segments[1].proved_still());
}

TEST(MovingSurfaces, ANoisyFrameProvesLess) {
  const MovingSurfaces surfaces({});
  Features f(3.0F, 0.2F);
  f.motion.camera_motion = CameraMotion{};
  f.motion.camera_motion->noise = 1.0;  // four sigma are 4 px
  EXPECT_FALSE(judged(surfaces, f).segments[0].proved_moving());
}

TEST(MovingSurfaces, WhatTheEgoMotionIsNotSureOfMovesButNotForSure) {
  const MovingSurfaces surfaces({});
  Features f(3.0F, 0.2F);
  EXPECT_TRUE(judged(surfaces, f).segments[0].proved_surely_moving());
  std::fill(f.motion.prediction_sigma.begin(), f.motion.prediction_sigma.end(), 1.0F);
  const Segment left = judged(surfaces, f).segments[0];
  EXPECT_TRUE(left.proved_moving());
  EXPECT_FALSE(left.proved_surely_moving());  // four sigma are 4 px
}

TEST(MovingSurfaces, AreFoundOnceTheyHaveKeptMoving) {
  MovingSurfaces surfaces({});
  const SegmentMap map = judged(surfaces, {3.0F, 0.2F});
  EXPECT_TRUE(surfaces.find(map, {}, 1.00).empty());
  EXPECT_TRUE(surfaces.find(map, {}, 1.05).empty());
  const auto found = surfaces.find(map, {}, 1.10);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].area, cv::Rect(40, 50, 60, 120));
  EXPECT_EQ(cv::countNonZero(found[0].mask), 60 * 120);
  // What an object holds already is not found again.
  EXPECT_TRUE(surfaces.find(map, found, 1.15).empty());
  EXPECT_TRUE(surfaces.find(map, found, 1.35).empty());
}

TEST(MovingSurfaces, AStopStartsTheTimeAnew) {
  MovingSurfaces surfaces({});
  const SegmentMap moving = judged(surfaces, {3.0F, 0.2F});
  surfaces.find(moving, {}, 1.0);
  surfaces.find(judged(surfaces, {0.2F, 0.2F}), {}, 1.05);
  EXPECT_TRUE(surfaces.find(moving, {}, 1.10).empty());
}

TEST(MovingSurfaces, NeedEnoughMovingFeaturesToBeLookedFor) {
  const MovingSurfaces surfaces({});
  EXPECT_TRUE(surfaces.worth_a_look(Features(3.0F, 0.2F).motion));
  EXPECT_FALSE(surfaces.worth_a_look(Features(1.0F, 0.2F).motion));
}

}  // namespace
}  // namespace dkp_slam

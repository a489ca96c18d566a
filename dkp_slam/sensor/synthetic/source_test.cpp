#include "dkp_slam/sensor/synthetic/source.h"

#include <cmath>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

SyntheticOptions options(std::uint64_t seed) {
  SyntheticOptions o;
  o.seed = seed;
  o.frames = 2;
  return o;
}

TEST(SyntheticSource, SameSeedSameBytesOnAnyNumberOfThreads) {
  SyntheticSource a(options(5)), b(options(5)), other(options(6));
  while (const auto frame = a.read()) {
    const int threads = cv::getNumThreads();
    cv::setNumThreads(1);
    const auto again = b.read();
    cv::setNumThreads(threads);
    ASSERT_TRUE(again);
    EXPECT_EQ(frame->timestamp, again->timestamp);
    EXPECT_TRUE(same(frame->colour, again->colour));
    EXPECT_TRUE(same(frame->depth, again->depth));
    EXPECT_TRUE(same(a.truth().mask, b.truth().mask));
    const auto different = other.read();
    EXPECT_FALSE(same(frame->colour, different->colour));
  }
  EXPECT_FALSE(b.read());
}

TEST(SyntheticSource, GivesFramesTruthAndStamps) {
  SyntheticOptions o = options(1);
  o.kinect_noise = false;
  SyntheticSource source(o);
  EXPECT_EQ(source.size(), 2U);
  const auto first = source.read(), second = source.read();
  EXPECT_EQ(second->index, 1);
  EXPECT_EQ(first->timestamp, 1000.0);
  EXPECT_EQ(second->timestamp, 1000.033333);
  EXPECT_EQ(second->colour.type(), CV_8UC3);
  EXPECT_EQ(second->depth.type(), CV_32FC1);
  EXPECT_TRUE(same(second->depth, source.truth().depth));
  const Se3 error =
      source.world_from_camera(second->timestamp).inverse() * source.truth().world_from_camera;
  EXPECT_LT(error.log().norm(), 1e-12);
}

TEST(SyntheticSource, NoiseDoesNotTouchTheTruth) {
  SyntheticOptions o = options(1);
  SyntheticSource noisy(o);
  o.kinect_noise = false;
  SyntheticSource clean(o);
  const auto a = noisy.read(), b = clean.read();
  EXPECT_TRUE(same(noisy.truth().depth, clean.truth().depth));
  EXPECT_FALSE(same(a->depth, b->depth));
  const double known = cv::countNonZero(a->depth > 0) / static_cast<double>(a->depth.total());
  EXPECT_GT(known, 0.7);
  EXPECT_LT(known, 0.99);
}

TEST(SyntheticMotion, IsSmoothAndSlowEnoughForAHand) {
  for (const SyntheticMotion motion :
       {SyntheticMotion::xyz, SyntheticMotion::halfsphere, SyntheticMotion::still}) {
    double path = 0.0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      for (int i = 0; i < 900; ++i) {
        const double t = i / 30.0;
        const Se3 step =
            camera_pose(motion, seed, t).inverse() * camera_pose(motion, seed, t + 1.0 / 30.0);
        path += step.translation.norm();
        EXPECT_LT(step.translation.norm() * 30.0, 1.2);  // metres per second
        EXPECT_LT(step.angle() * 30.0, 0.9);             // radians per second
      }
    }
    // Metres in three times thirty seconds.
    if (motion == SyntheticMotion::still) {
      EXPECT_LT(path, 3.0);
    } else {
      EXPECT_GT(path, 15.0);
    }
  }
}

TEST(SyntheticScenario, KnowsItsNames) {
  EXPECT_EQ(synthetic_scenario("static_xyz").people, 0);
  EXPECT_EQ(synthetic_scenario("walking_xyz").people, 2);
  EXPECT_EQ(synthetic_scenario("walking_static").motion, SyntheticMotion::still);
  EXPECT_EQ(synthetic_scenario("walking_halfsphere").motion, SyntheticMotion::halfsphere);
  EXPECT_THROW(synthetic_scenario("flying"), Error);
}

}  // namespace
}  // namespace dkp_slam

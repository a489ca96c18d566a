#include "dkp_slam/dynamics/removal/epipolar.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// F of a camera (focal length f, centre c) that moved by t without turning: K^-T [t]x K^-1.
cv::Matx33d fundamental_of_translation(const cv::Vec3d& t, double f, const cv::Point2d& c) {
  const cv::Matx33d skew(0, -t[2], t[1], t[2], 0, -t[0], -t[1], t[0], 0);
  const cv::Matx33d inverse(1 / f, 0, -c.x / f, 0, 1 / f, -c.y / f, 0, 0, 1);
  return inverse.t() * skew * inverse;
}

constexpr double focal = 500.0;
const cv::Point2d centre(320.0, 240.0);

TEST(EpipolarDistance, SidewaysMotionMakesHorizontalLines) {
  const cv::Matx33d f = fundamental_of_translation({0.05, 0.0, 0.0}, focal, centre);
  EXPECT_NEAR(epipolar_distance(f, {100, 200}, {90, 200}), 0.0, 1e-6);
  for (const float off : {0.5F, 1.0F, 7.0F}) {
    EXPECT_NEAR(epipolar_distance(f, {100, 200}, {90, 200 + off}), static_cast<double>(off), 1e-6);
    EXPECT_NEAR(epipolar_distance(f, {100, 200}, {40, 200 - off}), static_cast<double>(off), 1e-6);
  }
}

TEST(EpipolarDistance, ForwardMotionMakesLinesThroughTheCentre) {
  const cv::Matx33d f = fundamental_of_translation({0.0, 0.0, 0.1}, focal, centre);
  // The line from the centre to (350, 280) runs along (3, 4) / 5; across is (4, -3) / 5.
  EXPECT_NEAR(epipolar_distance(f, {350, 280}, {356, 288}), 0.0, 1e-6);
  EXPECT_NEAR(epipolar_distance(f, {350, 280}, {356 + 4, 288 - 3}), 5.0, 1e-6);
}

TEST(EpipolarDistance, DoesNotDependOnTheScaleOfF) {
  const cv::Matx33d f = fundamental_of_translation({0.03, -0.02, 0.1}, focal, centre);
  const double d = epipolar_distance(f, {120, 80}, {131, 77});
  EXPECT_GT(d, 0.0);
  EXPECT_NEAR(epipolar_distance(f * -37.0, {120, 80}, {131, 77}), d, 1e-9);
}

TEST(EstimateFundamental, WantsEnoughMatches) {
  PointMatches few;
  cv::RNG random(3);
  for (int i = 0; i < 14; ++i) {
    const cv::Point2f p(random.uniform(0.0F, 640.0F), random.uniform(0.0F, 480.0F));
    few.previous.push_back(p);
    few.current.push_back(p + cv::Point2f(random.uniform(1.0F, 9.0F), 0.0F));
    few.low.push_back(1);
  }
  EXPECT_FALSE(estimate_fundamental(few, {}));
}

}  // namespace
}  // namespace dkp_slam

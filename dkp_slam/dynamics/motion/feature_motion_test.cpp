#include "dkp_slam/dynamics/motion/feature_motion.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "dkp_slam/dynamics/motion/test_texture.h"

namespace dkp_slam {
namespace {

using testing::height;
using testing::texture;
using testing::width;

constexpr double focal = 260.0, wall = 2.0;  // pixels, metres

Camera camera() {
  Camera c;
  c.name = "small";
  c.width = width;
  c.height = height;
  c.fx = c.fy = focal;
  c.cx = width / 2.0;
  c.cy = height / 2.0;
  return c;
}

/// A wall at 2 m that has moved `room` pixels to the right; its left half by `somebody`.
cv::Mat picture(double room, double somebody) {
  cv::Mat image = texture(room, 0.0);
  const cv::Rect left(0, 0, width / 2, height);
  texture(somebody, 0.0)(left).copyTo(image(left));
  return image;
}

/// Points right (`room`) and left (`somebody`) of the middle, away from it.
std::vector<cv::Point2f> points(int room, int somebody) {
  std::vector<cv::Point2f> all;
  const auto add = [&](int count, float left) {
    for (int i = 0; i < count; ++i) {
      all.emplace_back(left + 11.0F * static_cast<float>(i % 8),
                       40.0F + 30.0F * static_cast<float>(i / 8));
    }
  };
  add(room, 205.0F);
  add(somebody, 30.0F);
  return all;
}

TEST(FeatureMotion, GoesOnFromTheLastMotionThatWasTold) {
  // A steady camera; in one image there is no depth and its motion is not told. In the next
  // somebody moves with more points than the room has. Nobody changes a camera's speed as fast as
  // that.
  FeatureMotionOptions options;
  options.coarse_rotation = false;  // people hide too much for it
  FeatureMotionEstimator estimator(camera(), options);
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const double shift = 2.0, metres = shift * wall / focal;
  constexpr int blind = 6, crowded = 7;
  double somebody = 0.0;
  for (int k = 0; k <= crowded; ++k) {
    somebody += k == crowded ? 24.0 : shift;
    const std::vector<cv::Point2f> at = k == crowded ? points(15, 16) : points(32, 32);
    const cv::Mat known = k == blind ? cv::Mat(depth.size(), CV_32FC1, cv::Scalar(0)) : depth;
    FeatureMotion motion =
        estimator.track(picture(k * shift, somebody), known, at, {}, {}, k / 30.0);
    estimator.measure_ego_motion(known, at, std::vector<std::uint8_t>(at.size(), 1), 1, motion);
    if (k == 0 || k == blind) {
      EXPECT_FALSE(motion.camera_motion) << k;
      continue;
    }
    ASSERT_TRUE(motion.camera_motion) << k;
    const Se3 found = motion.camera_motion->previous_from_current.inverse();
    EXPECT_NEAR(found.translation.x(), metres, 0.003) << k;
    EXPECT_LT(found.angle(), 0.003) << k;
  }
}

TEST(FeatureMotion, IsMeasuredAnewFromSupportThatTellsAnother) {
  const double shift = 6.0, metres = shift * wall / focal;
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> at = points(40, 56);  // somebody has more
  FeatureMotionOptions options;
  options.coarse_rotation = false;  // people hide too much for it
  FeatureMotionEstimator estimator(camera(), options);
  estimator.track(picture(0, 0), depth, at, {}, {}, 0.0);
  FeatureMotion motion = estimator.track(picture(shift, 0), depth, at, {}, {}, 1 / 30.0);
  const auto moved = [&] { return motion.camera_motion->previous_from_current.inverse(); };
  estimator.measure_ego_motion(depth, at, std::vector<std::uint8_t>(at.size(), 1), 1, motion);
  ASSERT_TRUE(motion.camera_motion);
  ASSERT_NEAR(moved().translation.x(), 0.0, 0.003) << "somebody's, to begin with";

  std::vector<std::uint8_t> room(at.size(), 0), nobody(at.size(), 0);
  std::fill_n(room.begin(), 40, 1);
  EXPECT_FALSE(estimator.measure_ego_motion_anew(depth, at, nobody, 1, motion));
  EXPECT_NEAR(moved().translation.x(), 0.0, 0.003);
  EXPECT_TRUE(estimator.measure_ego_motion_anew(depth, at, room, 1, motion));
  EXPECT_NEAR(moved().translation.x(), metres, 0.003);
  EXPECT_NEAR(estimator.current_from_previous().translation.x(), metres, 0.003);
  EXPECT_FALSE(estimator.measure_ego_motion_anew(depth, at, room, 1, motion)) << "it is that";
}

TEST(FeatureMotion, IsNotMeasuredAnewFromSupportThatIsAtOdds) {
  // Each eight of these forty move another way, but for sixteen: most agree with no motion at all.
  const double shift = 6.0;
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> at = points(40, 56);
  cv::Mat now = picture(shift, 0);
  const auto move_row = [&](int row, double right, double down) {
    const cv::Rect strip(width / 2, 25 + 30 * row, width / 2, 30);
    texture(right, down)(strip).copyTo(now(strip));
  };
  move_row(0, -shift, 0.0);
  move_row(1, 0.0, shift);
  move_row(2, 0.0, -shift);
  FeatureMotionOptions options;
  options.coarse_rotation = false;
  FeatureMotionEstimator estimator(camera(), options);
  estimator.track(picture(0, 0), depth, at, {}, {}, 0.0);
  FeatureMotion motion = estimator.track(now, depth, at, {}, {}, 1 / 30.0);
  estimator.measure_ego_motion(depth, at, std::vector<std::uint8_t>(at.size(), 1), 1, motion);
  ASSERT_TRUE(motion.camera_motion);
  std::vector<std::uint8_t> room(at.size(), 0);
  std::fill_n(room.begin(), 40, 1);
  EXPECT_FALSE(estimator.measure_ego_motion_anew(depth, at, room, 1, motion));
  EXPECT_NEAR(estimator.current_from_previous().translation.x(), 0.0, 0.003);
}

TEST(FeatureMotion, IsMeasuredForPointsThatComeLater) {
  const double shift = 6.0;
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> later = points(3, 3);
  FeatureMotionEstimator estimator(camera(), {});
  estimator.track(picture(0, 0), depth, {}, {}, {}, 0.0);
  estimator.track(picture(shift, 0), depth, {}, {}, {}, 1 / 30.0);
  CameraMotion rooms;
  rooms.previous_from_current.translation.x() = -shift * wall / focal;
  const FeatureMotion found = estimator.measure(depth, later, rooms);
  for (std::size_t i = 0; i < later.size(); ++i) {
    ASSERT_TRUE(found.tracks.tracked[i]) << i;
    EXPECT_NEAR(static_cast<double>(found.residual[i]), i < 3 ? 0.0 : shift, 0.1) << i;
  }
}

TEST(FeatureMotion, IsNotToldWhereNobodyCarriesACameraSoFast) {
  const double shift =
      6.0;  // pixels, 46 mm: 1.4 m/s in a thirtieth of a second, 4.6 in a hundredth
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> at = points(40, 40);
  for (const double passed : {1.0 / 30.0, 0.01}) {
    FeatureMotionOptions options;
    options.coarse_rotation = false;
    FeatureMotionEstimator estimator(camera(), options);
    estimator.track(picture(0, 0), depth, at, {}, {}, 0.0);
    FeatureMotion motion = estimator.track(picture(shift, shift), depth, at, {}, {}, passed);
    estimator.measure_ego_motion(depth, at, std::vector<std::uint8_t>(at.size(), 1), 1, motion);
    EXPECT_EQ(motion.camera_motion.has_value(), passed > 0.02);
  }
}

TEST(FeatureMotion, IsRefinedByMoreThatAgreesWithIt) {
  // What is at the left is a pixel off, as where a motion told by one corner of the image leads.
  const double shift = 6.0, off = 1.0;
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> at = points(40, 40);
  FeatureMotionEstimator estimator(camera(), {});
  estimator.track(picture(0, 0), depth, at, {}, {}, 0.0);
  FeatureMotion motion = estimator.track(picture(shift, shift + off), depth, at, {}, {}, 1 / 30.0);
  std::vector<std::uint8_t> support(at.size(), 0), more(at.size(), 1);
  std::fill_n(support.begin(), 40, 1);
  std::fill_n(more.begin(), 40, 0);
  estimator.measure_ego_motion(depth, at, support, 1, motion);
  ASSERT_TRUE(motion.camera_motion);
  const auto worst = [&] {
    return *std::max_element(motion.residual.begin(), motion.residual.end());
  };
  EXPECT_GT(worst(), 0.8 * off);
  EXPECT_TRUE(estimator.refine_ego_motion(depth, at, support, more, motion));
  EXPECT_LT(worst(), 0.8 * off);
  EXPECT_EQ(motion.camera_motion->inliers, 80);
  EXPECT_TRUE((estimator.current_from_previous() * motion.camera_motion->previous_from_current)
                  .translation.isZero(1e-9));
}

TEST(FeatureMotion, IsNotRefinedByThoseWhoPullItOffItsSupport) {
  // All over the image three features to one of the support are off by 2.3 pixels, as on somebody
  // who walks slowly and whom the masks have missed.
  const double shift = 6.0;
  const cv::Mat depth(height, width, CV_32FC1, cv::Scalar(wall));
  const std::vector<cv::Point2f> at = points(56, 56);
  FeatureMotionOptions options;
  options.min_low_points = 20;
  FeatureMotionEstimator estimator(camera(), options);
  estimator.track(picture(0, 0), depth, at, {}, {}, 0.0);
  FeatureMotion motion = estimator.track(picture(shift, shift), depth, at, {}, {}, 1 / 30.0);
  std::vector<std::uint8_t> support(at.size(), 0), more(at.size(), 1);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (i % 4 == 0) {
      support[i] = 1;
      more[i] = 0;
    } else {
      motion.then[i].x += 2.3F;
    }
  }
  estimator.measure_ego_motion(depth, at, support, 1, motion);
  ASSERT_TRUE(motion.camera_motion && motion.from_low_points);
  const Se3 before = motion.camera_motion->previous_from_current;
  EXPECT_FALSE(estimator.refine_ego_motion(depth, at, support, more, motion));
  EXPECT_TRUE((before * motion.camera_motion->previous_from_current.inverse()).log().isZero(1e-12));
  EXPECT_TRUE((estimator.current_from_previous() * before).log().isZero(1e-9));
}

}  // namespace
}  // namespace dkp_slam

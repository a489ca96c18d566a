#include "dkp_slam/dynamics/compensation/motion_history.h"

#include <gtest/gtest.h>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

constexpr double interval = 0.05;  // seconds from frame to frame

/// A wall 4 m off and a body 2 m off, 100 x 200 px, that moves `speed` px a frame.
struct Scenery {
  float speed = 6.0F;
  float left = 100.0F;
  bool body_has_features = true;

  cv::Rect2f box(int frame) const { return {left + speed * float(frame), 120, 100, 200}; }
  DepthView view(int frame) const {
    cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(4.0F));
    depth(cv::Rect(box(frame)) & cv::Rect(0, 0, 640, 480)) = 2.0F;
    return make_depth_view(depth, depth_view_rays(testing::vga_camera()));
  }
  void add(int frame, MotionHistory& history) const {
    std::vector<cv::Point2f> points;
    FlowResult tracks;
    for (int y = 10; y < 480; y += 20) {
      for (int x = 10; x < 640; x += 20) {
        const cv::Point2f p{float(x), float(y)};
        const bool on_body = box(frame).contains(p);
        if (on_body && !body_has_features) continue;
        points.push_back(p);
        tracks.previous.push_back(on_body ? p - cv::Point2f(speed, 0) : p);
      }
    }
    tracks.tracked.assign(points.size(), 1);
    history.add(frame * interval, view(frame), points, tracks);
  }
};

MotionHistory history_of(const Scenery& scenery, int frames) {
  MotionHistory history(testing::vga_camera(), {}, 1.0);
  for (int i = 0; i < frames; ++i) scenery.add(i, history);
  return history;
}

TEST(MotionHistory, FollowsTheBodyNotTheWallBehindIt) {
  const Scenery scenery;
  const auto carried =
      history_of(scenery, 9)
          .carry(scenery.box(2) - cv::Point2f(20, 0) + cv::Size2f(40, 0), {}, 2 * interval);
  ASSERT_TRUE(carried.has_value());
  EXPECT_NEAR(carried->shift.x, 6 * 6.0F, 0.5F);
  EXPECT_NEAR(carried->shift.y, 0.0F, 0.5F);
  EXPECT_NEAR(carried->velocity.x, 6.0 / interval, 1.0);
  EXPECT_NEAR(carried->depth, 2.0F, 0.02F);
  EXPECT_NEAR(carried->box.width, 140.0F, 1.0F);
}

TEST(MotionHistory, AnImageThatWasDroppedLiesBetweenTwoFrames) {
  const Scenery scenery;
  const auto carried = history_of(scenery, 9).carry(scenery.box(6), {}, 6.5 * interval);
  ASSERT_TRUE(carried.has_value());
  EXPECT_NEAR(carried->shift.x, 1.5F * 6.0F, 0.5F);
}

TEST(MotionHistory, NothingMovesWithinItsOwnFrame) {
  const Scenery scenery;
  const auto carried = history_of(scenery, 3).carry(scenery.box(2), {}, 2 * interval);
  ASSERT_TRUE(carried.has_value());
  EXPECT_EQ(carried->box, scenery.box(2));
}

TEST(MotionHistory, FallsBackOnTheCamerasMotion) {
  Scenery scenery;
  scenery.speed = 0.0F;
  scenery.body_has_features = false;
  MotionHistory history(testing::vga_camera(), {}, 1.0);
  Se3 slide;  // the camera moves 2 cm to the left a frame: at 2 m that is 5.25 px to the right
  slide.translation.x() = 0.02;
  for (int i = 0; i < 5; ++i) {
    scenery.add(i, history);
    history.set_ego_motion(slide);
  }
  const auto carried = history.carry(scenery.box(0), {}, 0.0);
  ASSERT_TRUE(carried.has_value());
  EXPECT_NEAR(carried->shift.x, 4 * 5.25F, 0.1F);
}

TEST(MotionHistory, TakesTheSilhouettesDepth) {
  const Scenery scenery;
  const cv::Rect2f wide(60, 100, 300, 300);  // mostly wall
  cv::Mat silhouette = cv::Mat::zeros(300, 300, CV_8UC1);
  silhouette(cv::Rect(40, 20, 100, 200)) = 255;
  const auto carried = history_of(scenery, 5).carry(wide, silhouette, 0.0);
  ASSERT_TRUE(carried.has_value());
  EXPECT_NEAR(carried->depth, 2.0F, 0.02F);
  EXPECT_NEAR(carried->shift.x, 4 * 6.0F, 0.5F);
  EXPECT_EQ(cv::countNonZero(carried->mask.mask), 50 * 100);  // pixels of the view
}

TEST(MotionHistory, ForgetsWhatIsBeforeAnAnswerAndNothingElse) {
  const Scenery scenery;
  const MotionHistory whole = history_of(scenery, 9);
  MotionHistory rest = whole;
  rest.forget_before(4.5 * interval);  // an image that was dropped
  EXPECT_FALSE(rest.carry(scenery.box(3), {}, 3 * interval).has_value());
  for (const double frame : {4.6, 5.0, 6.5, 8.0}) {
    const cv::Rect2f box = scenery.box(static_cast<int>(frame));
    const auto expected = whole.carry(box, {}, frame * interval);
    const auto carried = rest.carry(box, {}, frame * interval);
    ASSERT_TRUE(expected && carried) << frame;
    EXPECT_EQ(carried->box, expected->box) << frame;
    EXPECT_EQ(carried->velocity, expected->velocity) << frame;
  }
  rest.forget_before(100.0);  // a detector that runs ahead
  EXPECT_TRUE(rest.carry(scenery.box(8), {}, 8 * interval).has_value());
}

TEST(MotionHistory, KnowsNothingOfWhatIsTooLongAgo) {
  const Scenery scenery;
  const MotionHistory history = history_of(scenery, 40);  // 1.95 s
  EXPECT_TRUE(history.carry(scenery.box(20), {}, 20 * interval).has_value());
  EXPECT_FALSE(history.carry(scenery.box(10), {}, 10 * interval).has_value());
  EXPECT_FALSE(
      MotionHistory(testing::vga_camera(), {}, 1.0).carry(scenery.box(0), {}, 0.0).has_value());
}

TEST(MovedBox, GrowsAsItComesNearer) {
  const cv::Rect2f box(100, 100, 100, 200);
  EXPECT_EQ(moved_box(box, {10, -5}, 0.0F, 2.0F), cv::Rect2f(110, 95, 100, 200));
  const cv::Rect2f nearer = moved_box(box, {0, 0}, 2.2F, 2.0F);
  EXPECT_NEAR(nearer.width, 110.0F, 1e-3F);
  EXPECT_NEAR(nearer.x, 95.0F, 1e-3F);
  EXPECT_NEAR(moved_box(box, {0, 0}, 4.0F, 1.0F).width, 125.0F, 1e-3F);  // another surface's depth
}

}  // namespace
}  // namespace dkp_slam

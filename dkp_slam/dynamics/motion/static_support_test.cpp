#include "dkp_slam/dynamics/motion/static_support.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

using Flags = std::vector<std::uint8_t>;

TEST(StaticSupport, IsWhatLiesOutsideAllBoxes) {
  const std::vector<cv::Point2f> points = {{10, 10}, {60, 60}, {150, 60}, {300, 300}};
  EXPECT_EQ(outside_boxes(points, {{50, 50, 50, 50}, {140, 50, 20, 20}}), (Flags{1, 0, 0, 1}));
  EXPECT_EQ(outside_boxes(points, {}), (Flags{1, 1, 1, 1}));
}

TEST(StaticSupport, ThinsWhatLiesOutsideTheBoxesEvenly) {
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2.0F));
  depth.col(400) = 0.0F;
  const std::vector<cv::Point2f> points = {{10, 10},  {60, 60},   {45, 60},   {30, 60},
                                           {400, 99}, {300, 300}, {310, 300}, {320, 300}};
  const std::vector<cv::Rect2f> boxes{{50, 50, 50, 50}};
  // In the box, within the margin; of 10, 30, 300, 310 and 320 every second; none without depth.
  EXPECT_EQ(thinned_outside(points, boxes, 8.0F, depth, 3), (Flags{1, 1, 1, 1, 0, 0, 1, 0}));
  EXPECT_EQ(thinned_outside(points, boxes, 8.0F, depth, 9), (Flags{1, 1, 1, 1, 0, 1, 1, 1}));
  EXPECT_EQ(thinned_outside(points, boxes, 8.0F, depth, 0), (Flags{0, 1, 1, 0, 0, 0, 0, 0}));
}

TEST(StaticSupport, LooksCloserWhereAThirdMoves) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  // Two of five move at the left; at the right one alone, and below two of seven.
  std::vector<cv::Point2f> points = {{50, 50}, {70, 90}, {90, 50}, {95, 70}, {110, 50}, {60, 60}};
  std::vector<float> residual = {5.0F, 3.0F, 0.1F, 0.2F, 0.1F, none};
  Flags expected(points.size(), 1);
  points.emplace_back(600, 50);
  residual.push_back(9.0F);
  expected.push_back(0);
  for (int i = 0; i < 7; ++i) {
    points.emplace_back(330 + i, 400);
    residual.push_back(i < 2 ? 5.0F : 0.1F);
    expected.push_back(0);
  }
  EXPECT_EQ(near_moving(points, residual, 1.5F, {640, 480}), expected);
}

TEST(StaticSupport, TakesPointsOnAPlaneInBoxesToo) {
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0F));
  depth.colRange(200, 300) = 2.0F;
  const DepthView view = make_depth_view(depth, depth_view_rays(testing::vga_camera()));
  const Plane wall{Eigen::Vector3f::UnitZ(), 3.0F};
  Flags flags{0, 0, 1};
  add_points_on_planes(view, {{100, 100}, {250, 100}, {260, 100}}, {wall}, {}, flags);
  EXPECT_EQ(flags, (Flags{1, 0, 1}));  // on the wall, before it, and what was flagged stays
}

/// A wall, in view at the left and the right, 80 features on each side, and 200 on somebody round
/// between them.
struct Crowded {
  DepthView view;
  std::vector<cv::Point2f> points;
  Flags support, on_wall;
  FeatureMotion motion;
};

Crowded crowded() {
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0F));
  const cv::Range somebody(200, 440);
  for (int u = somebody.start; u < somebody.end; ++u) {
    depth.col(u) = 1.8 - 0.3 * std::sin(CV_PI * (u - somebody.start) / somebody.size());
  }
  Crowded scene;
  scene.view = make_depth_view(depth, depth_view_rays(testing::vga_camera()));
  const auto add = [&](int from, int to, int rows, bool wall) {
    for (int u = from; u < to; u += 20) {
      for (int r = 0; r < rows; ++r) {
        scene.points.emplace_back(u, 40 + 40 * r);
        scene.on_wall.push_back(wall ? 1 : 0);
      }
    }
  };
  add(30, 190, 10, true);
  add(220, 420, 10, false);
  add(220, 420, 10, false);
  add(450, 610, 10, true);
  scene.support.assign(scene.points.size(), 1);
  scene.motion.tracks.tracked.assign(scene.points.size(), 1);
  return scene;
}

/// Residuals of `wall` and `somebody`, pixels.
Flags left_behind(Crowded scene, float wall, float somebody) {
  for (const std::uint8_t on : scene.on_wall) {
    scene.motion.residual.push_back(on != 0 ? wall : somebody);
  }
  return planes_left_behind(scene.view, scene.points, scene.support, scene.motion, 2.0F, {}, 1);
}

TEST(StaticSupport, ALargePlaneThatIsLeftBehindIsTheRoom) {
  const Crowded scene = crowded();
  EXPECT_EQ(left_behind(scene, 8.0F, 0.5F), scene.on_wall) << "the motion is somebody's";
  EXPECT_EQ(left_behind(scene, 0.5F, 8.0F), Flags()) << "it is the room's";
  EXPECT_EQ(left_behind(scene, 0.5F, 0.5F), Flags()) << "nobody moves";
  const float none = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(left_behind(scene, none, none), scene.on_wall) << "no motion was told";
}

TEST(StaticSupport, NothingIsLeftBehindThatIsSmallOrHasFewFeatures) {
  Crowded scene = crowded();
  scene.view.depth.rowRange(0, 200) = 0.0F;  // half a metre of the wall is left: a shelf
  EXPECT_EQ(left_behind(scene, 8.0F, 0.5F), Flags());

  scene = crowded();
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.on_wall[i] != 0 && i % 8 != 0) scene.support[i] = 0;
  }
  EXPECT_EQ(left_behind(scene, 8.0F, 0.5F), Flags());

  scene = crowded();
  scene.motion.tracks.tracked.assign(scene.points.size(), 0);
  EXPECT_EQ(left_behind(scene, 8.0F, 0.5F), Flags());
}

}  // namespace
}  // namespace dkp_slam

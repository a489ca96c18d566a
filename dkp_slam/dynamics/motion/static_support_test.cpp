#include "dkp_slam/dynamics/motion/static_support.h"

#include <limits>

#include <gtest/gtest.h>

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
  Camera camera;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0F));
  depth.colRange(200, 300) = 2.0F;
  const DepthView view = make_depth_view(depth, depth_view_rays(camera));
  const Plane wall{Eigen::Vector3f::UnitZ(), 3.0F};
  Flags flags{0, 0, 1};
  add_points_on_planes(view, {{100, 100}, {250, 100}, {260, 100}}, {wall}, {}, flags);
  EXPECT_EQ(flags, (Flags{1, 0, 1}));  // on the wall, before it, and what was flagged stays
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/dynamics/motion/static_support.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using Flags = std::vector<std::uint8_t>;

TEST(StaticSupport, IsWhatLiesOutsideAllBoxes) {
  const std::vector<cv::Point2f> points = {{10, 10}, {60, 60}, {150, 60}, {300, 300}};
  EXPECT_EQ(outside_boxes(points, {{50, 50, 50, 50}, {140, 50, 20, 20}}), (Flags{1, 0, 0, 1}));
  EXPECT_EQ(outside_boxes(points, {}), (Flags{1, 1, 1, 1}));
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

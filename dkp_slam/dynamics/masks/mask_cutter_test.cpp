#include "dkp_slam/dynamics/masks/mask_cutter.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// A body 2 m off, 100 px wide, before a wall 4 m off.
DepthView view_of_body() {
  Camera camera;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(4.0F));
  for (int x = 0; x < 100; ++x) {
    const float u = (static_cast<float>(x) + 0.5F) / 50.0F - 1.0F;
    depth.col(250 + x).rowRange(100, 400) = 2.12F - 0.14F * std::sqrt(1.0F - u * u);
  }
  return make_depth_view(depth, depth_view_rays(camera));
}

const cv::Rect2f box(240, 95, 120, 310);

ObjectMask cut(ClusteringMode mode) {
  ClusteringOptions options;
  options.mode = mode;
  const MaskCutter cutter(options, 525.0);
  return cutter.cut(cutter.scene(view_of_body(), {}, 1), box, {}, 1);
}

TEST(MaskCutter, CutsABodyOutOfItsBox) {
  for (const auto mode : {ClusteringMode::adaptive, ClusteringMode::band}) {
    const ObjectMask mask = cut(mode);
    ASSERT_FALSE(mask.empty());
    EXPECT_NEAR(mask.mean_depth, 2.0F, 0.05F);
    const int body = 50 * 150;  // pixels of the view
    EXPECT_NEAR(cv::countNonZero(mask.mask), body, 0.03 * body);
  }
}

TEST(MaskCutter, EquationOneToTheLetterTakesTheWholeBox) {
  const ObjectMask mask = cut(ClusteringMode::paper);  // N is thousands, so K is 1
  EXPECT_EQ(mask.clusters, 1);
  EXPECT_GE(cv::countNonZero(mask.mask), 0.98 * 60 * 155);
}

TEST(MaskCutter, SaysHowItCuts) {
  EXPECT_EQ(MaskCutter({}, 525.0).name(), "masks by clusters and surfaces");
  ClusteringOptions options;
  options.mode = ClusteringMode::paper;
  EXPECT_EQ(MaskCutter(options, 525.0).name(), "masks by Algorithm 1");
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/feature/frame_features.h"

#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

Camera plain_camera() {
  Camera camera;
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

OrbFeatures random_features(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0.0F, 639.0F), v(0.0F, 479.0F);
  OrbFeatures orb;
  for (int i = 0; i < count; ++i) {
    orb.keypoints.emplace_back(u(random), v(random), 31.0F, 10.0F, 1.0F, i % 8);
    orb.descriptors.push_back({static_cast<std::uint64_t>(i), 0, 0, 0});
  }
  return orb;
}

TEST(FrameFeatures, FindAgreesWithLookingAtEveryFeature) {
  const FrameFeatures features(random_features(4000), cv::Mat::zeros(480, 640, CV_32F), plain_camera());
  std::vector<int> found;
  for (const cv::Point2f centre : {cv::Point2f(0, 0), cv::Point2f(320, 240), cv::Point2f(639, 479)}) {
    features.find(centre, 37.5F, 2, 4, found);
    std::vector<int> expected;
    for (int i = 0; i < features.size(); ++i) {
      if (features.level[i] >= 2 && features.level[i] <= 4 &&
          std::abs(features.pixel[i].x - centre.x) <= 37.5F &&
          std::abs(features.pixel[i].y - centre.y) <= 37.5F) {
        expected.push_back(i);
      }
    }
    std::sort(found.begin(), found.end());
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(found, expected);
  }
}

TEST(FrameFeatures, DepthAndRightCoordinateOfAPlane) {
  const Camera camera = plain_camera();
  const FrameFeatures features(random_features(50), cv::Mat(480, 640, CV_32F, cv::Scalar(2.0)), camera);
  for (int i = 0; i < features.size(); ++i) {
    EXPECT_FLOAT_EQ(features.depth[i], 2.0F);
    EXPECT_NEAR(features.right_u(i, camera), features.pixel[i].x - 500.0 * 0.075 / 2.0, 1e-9);
  }
}

TEST(FrameFeatures, SubsetKeepsWhatIsFlagged) {
  const FrameFeatures all(random_features(30), cv::Mat::zeros(480, 640, CV_32F), plain_camera());
  std::vector<char> keep(30, 0);
  keep[4] = keep[17] = 1;
  const FrameFeatures some = all.subset(keep);
  ASSERT_EQ(some.size(), 2);
  EXPECT_EQ(some.descriptor[1], all.descriptor[17]);
  std::vector<int> found;
  some.find(all.pixel[4], 1.0F, 0, 7, found);
  EXPECT_EQ(found, std::vector<int>{0});
}

}  // namespace
}  // namespace dkp_slam

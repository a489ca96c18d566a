#include "dkp_slam/feature/frame_features.h"

#include <algorithm>
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
  const FrameFeatures features(random_features(4000), cv::Mat::zeros(480, 640, CV_32F),
                               plain_camera());
  std::vector<int> found;
  for (const cv::Point2f centre :
       {cv::Point2f(0, 0), cv::Point2f(320, 240), cv::Point2f(639, 479)}) {
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
  const FrameFeatures features(random_features(50), cv::Mat(480, 640, CV_32F, cv::Scalar(2.0)),
                               camera);
  for (int i = 0; i < features.size(); ++i) {
    EXPECT_FLOAT_EQ(features.depth[i], 2.0F);
    EXPECT_NEAR(features.right_u(i, camera), features.pixel[i].x - 500.0 * 0.075 / 2.0, 1e-9);
  }
}

TEST(FrameFeatures, DepthOfAnotherMomentIsCarriedBack) {
  // A step: 1 m on the left of u = 320, 3 m on the right. Between the two images the camera moved
  // 2 cm to the right and 1 cm forward, so what the colour image sees at u, the depth image sees
  // 10 px (at 1 m) further left, and 1 cm nearer.
  const Camera camera = plain_camera();
  cv::Mat depth(480, 640, CV_32F, cv::Scalar(3.0));
  depth.colRange(0, 320) = 1.0F;
  OrbFeatures orb;
  for (float u : {100.0F, 325.0F, 600.0F}) {
    orb.keypoints.emplace_back(u, 240.0F, 31.0F, 0.0F, 1.0F, 0);
    orb.descriptors.emplace_back();
  }
  Se3 depth_from_colour;
  depth_from_colour.translation = {-0.02, 0.0, -0.01};
  const FrameFeatures features(orb, depth, camera, depth_from_colour);
  EXPECT_NEAR(features.depth[0], 1.01F, 1e-5);
  EXPECT_NEAR(features.depth[1], 3.01F, 1e-5);  // still right of the step: 3.3 px at 3 m
  EXPECT_NEAR(features.depth[2], 3.01F, 1e-5);
}

TEST(FrameFeatures, DepthIsThatOfTheMiddleRowToo) {
  // Towards what is seen at 1 m/s: the first row is read 10 ms before the middle one, 1 cm farther
  // away, the last one 1 cm nearer. Once more with no motion: as it was seen.
  Camera camera = plain_camera();
  camera.readout = 0.02;
  OrbFeatures orb;
  for (float v : {0.0F, 240.0F, 479.0F}) {
    orb.keypoints.emplace_back(320.0F, v, 31.0F, 0.0F, 1.0F, 0);
    orb.descriptors.emplace_back();
  }
  FrameFeatures features(orb, cv::Mat(480, 640, CV_32F, cv::Scalar(2.0)), camera);
  Vector6d forward = Vector6d::Zero();
  forward[2] = -1.0;
  features.correct_rolling_shutter(camera, forward);
  EXPECT_NEAR(features.depth[0], 1.99F, 1e-4);
  EXPECT_NEAR(features.depth[1], 2.0F, 1e-4);
  EXPECT_NEAR(features.depth[2], 2.01F, 1e-4);
  features.correct_rolling_shutter(camera, Vector6d::Zero());
  for (const float depth : features.depth) EXPECT_EQ(depth, 2.0F);
  camera.depth_readout = 0.0;
  features.correct_rolling_shutter(camera, forward);
  for (const float depth : features.depth) EXPECT_EQ(depth, 2.0F) << "of one moment";
  const FrameFeatures last = features.subset({0, 0, 1});
  EXPECT_EQ(last.seen_depth, std::vector<float>{2.0F});
}

TEST(FrameFeatures, ComeBackFromTheirParts) {
  Camera camera = plain_camera();
  camera.distortion.k1 = 0.1;
  FrameFeatures all(random_features(30), cv::Mat(480, 640, CV_32F, cv::Scalar(2.0)), camera);
  all.correct_rolling_shutter(camera, Vector6d::Zero());
  const FrameFeatures back(camera, all.pixel, all.depth, all.level, all.angle, all.descriptor);
  ASSERT_EQ(back.size(), 30);
  EXPECT_EQ(back.depth, all.depth);
  EXPECT_EQ(back.descriptor, all.descriptor);
  std::vector<int> expected, found;
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(back.seen_pixel[i], all.seen_pixel[i]);  // it was corrected by nothing
    EXPECT_EQ(back.seen_depth[i], all.seen_depth[i]);
    EXPECT_NEAR(back.raw_pixel[i].x, all.raw_pixel[i].x, 0.02);
    EXPECT_NEAR(back.raw_pixel[i].y, all.raw_pixel[i].y, 0.02);
    all.find(all.pixel[i], 40.0F, 0, 7, expected);
    back.find(all.pixel[i], 40.0F, 0, 7, found);
    EXPECT_EQ(found, expected);
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

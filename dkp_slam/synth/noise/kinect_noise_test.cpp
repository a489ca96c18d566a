#include "dkp_slam/synth/noise/kinect_noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam {
namespace {

TEST(KinectNoise, GrowsWithTheSquareOfTheDepthAsTheCameraFileSays) {
  const Camera camera = SyntheticOptions::default_camera();
  for (const float z : {1.0F, 2.0F, 4.0F}) {
    cv::RNG rng(5);
    const cv::Mat noisy = kinect_depth(cv::Mat(480, 640, CV_32FC1, cv::Scalar(z)), camera, rng);
    EXPECT_EQ(cv::countNonZero(noisy > 0), 480 * 640) << "no holes on a flat wall";
    cv::Scalar mean, deviation;
    cv::meanStdDev(noisy, mean, deviation);
    EXPECT_NEAR(mean[0], z, 0.003 * z * z);
    // Noise of the camera's size, and rounding to eighths of a pixel of disparity.
    const double fb = camera.fx * camera.baseline;
    const double rounding = z * z / fb / 8.0 / std::sqrt(12.0);
    const double expected = std::hypot(camera.depth_noise.quadratic * z * z, rounding);
    EXPECT_GT(deviation[0], 0.5 * expected);
    EXPECT_LT(deviation[0], 1.3 * expected);
  }
}

TEST(KinectNoise, IsTheSameInMetresAtAnySize) {
  const Camera usual = SyntheticOptions::default_camera();
  for (const int width : {320, 640, 1280}) {
    const Camera camera = resized(usual, width, 240);
    cv::RNG rng(5);
    cv::Mat noisy = kinect_depth(cv::Mat(240, width, CV_32FC1, cv::Scalar(3.0)), camera, rng);
    cv::Scalar mean, deviation;
    cv::meanStdDev(noisy, mean, deviation);
    EXPECT_NEAR(mean[0], 3.0, 0.01) << width;
    EXPECT_NEAR(deviation[0], 0.0142, 0.0020) << width;
    // Readings differ by whole eighths of a pixel of disparity at 640.
    const auto first = noisy.at<float>(0, 0);
    for (int x = 0; x < width; ++x) {
      const double apart = usual.fx * usual.baseline * (1.0 / noisy.at<float>(0, x) - 1.0 / first);
      EXPECT_NEAR(8.0 * apart, std::round(8.0 * apart), 1e-3) << width;
    }
  }
}

TEST(KinectNoise, ForegroundCastsAShadowToItsLeft) {
  const Camera camera = SyntheticOptions::default_camera();
  cv::Mat depth(60, 640, CV_32FC1, cv::Scalar(3.0));
  depth.colRange(300, 400).setTo(1.0);
  cv::RNG rng(5);
  const cv::Mat noisy = kinect_depth(depth, camera, rng);
  // Disparities 40.2 and 13.4 pixels: 26.8 pixels beside the box see no light.
  for (int x = 280; x < 295; ++x) EXPECT_EQ(cv::countNonZero(noisy.col(x)), 0) << x;
  EXPECT_EQ(cv::countNonZero(noisy.col(265)), 60);
  EXPECT_EQ(cv::countNonZero(noisy.col(350)), 60);
  EXPECT_EQ(cv::countNonZero(noisy.col(410)), 60);
}

TEST(KinectNoise, OutOfRangeIsUnknown) {
  const Camera camera = SyntheticOptions::default_camera();
  cv::RNG rng(5);
  for (const double z : {0.0, 0.2, 9.5}) {
    EXPECT_EQ(cv::countNonZero(kinect_depth(cv::Mat(20, 30, CV_32FC1, cv::Scalar(z)), camera, rng)),
              0);
  }
}

TEST(KinectNoise, SeesNothingNearAndEverLessFarAway) {
  const Camera camera = SyntheticOptions::default_camera();
  const auto seen = [&](double z) {
    cv::RNG rng(5);
    const cv::Mat depth = kinect_depth(cv::Mat(240, 320, CV_32FC1, cv::Scalar(z)), camera, rng);
    return cv::countNonZero(depth) / static_cast<double>(depth.total());
  };
  EXPECT_EQ(seen(0.35), 0.0);
  EXPECT_EQ(seen(0.45), 1.0);
  EXPECT_EQ(seen(4.4), 1.0);
  EXPECT_NEAR(seen(6.0), 0.5, 0.06);
  EXPECT_LT(seen(7.0), 0.2);
  EXPECT_EQ(seen(7.6), 0.0);
}

TEST(KinectNoise, ImageNoiseHasTheGivenSize) {
  cv::Mat image(200, 200, CV_8UC3, cv::Scalar(100, 120, 140));
  cv::RNG rng(5);
  add_image_noise(&image, 2.0, rng);
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 100 + 20 * c, 0.05);
    EXPECT_NEAR(deviation[c], std::hypot(2.0, 1.0 / std::sqrt(12.0)), 0.05);
  }
}

}  // namespace
}  // namespace dkp_slam

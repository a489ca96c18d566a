#include "dkp_slam/sensor/depth_registration.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

Camera camera_of(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

TEST(DepthRegistration, MovesAWallByTheDistanceOfTheCameras) {
  const Camera camera = camera_of(40, 30, 100.0);
  // The colour camera is 4 cm to the right: at 2 m that is two pixels to the left.
  const DepthRegistration registration(camera, camera, {{1, 0, 0, 0}, {-0.04, 0, 0}});
  const cv::Mat wall(30, 40, CV_32FC1, cv::Scalar(2.0F));
  const cv::Mat seen = registration.registered(wall);
  EXPECT_EQ(cv::countNonZero(seen == 2.0F), 30 * 38);
  EXPECT_EQ(cv::countNonZero(seen.colRange(0, 38) == 2.0F), 30 * 38);
}

TEST(DepthRegistration, LeavesNoHolesInALargerImage) {
  const DepthRegistration registration(camera_of(40, 30, 100.0), camera_of(120, 90, 300.0), Se3());
  cv::Mat wall(30, 40, CV_32FC1, cv::Scalar(2.0F));
  wall.at<float>(5, 7) = 0.0F;
  const cv::Mat seen = registration.registered(wall);
  ASSERT_EQ(seen.size(), cv::Size(120, 90));
  EXPECT_EQ(cv::countNonZero(seen), 120 * 90 - 9);
  EXPECT_EQ(cv::countNonZero(seen(cv::Rect(21, 15, 3, 3))), 0);
}

TEST(DepthRegistration, TheNearestCounts) {
  const Camera camera = camera_of(40, 30, 100.0);
  const DepthRegistration registration(camera, camera, {{1, 0, 0, 0}, {-0.04, 0, 0}});
  cv::Mat scene(30, 40, CV_32FC1, cv::Scalar(2.0F));
  scene(cv::Rect(20, 10, 4, 4)).setTo(1.0F);  // four pixels to the left in the colour image
  const cv::Mat seen = registration.registered(scene);
  EXPECT_EQ(cv::countNonZero(seen(cv::Rect(16, 10, 4, 4)) == 1.0F), 16);
  EXPECT_EQ(cv::countNonZero(seen == 1.0F), 16);
  // Behind it, to the right, the depth camera saw nothing.
  EXPECT_EQ(cv::countNonZero(seen(cv::Rect(20, 10, 2, 4))), 0);
}

TEST(DepthRegistration, TurnsWithTheCamera) {
  const Camera camera = camera_of(41, 31, 100.0);
  // Half a turn about the axis of view.
  const DepthRegistration registration(camera, camera, {{0, 0, 0, 1}, {0, 0, 0}});
  cv::Mat scene(31, 41, CV_32FC1, cv::Scalar(0.0F));
  scene.at<float>(3, 5) = 1.5F;
  const cv::Mat seen = registration.registered(scene);
  EXPECT_EQ(cv::countNonZero(seen), 1);
  EXPECT_FLOAT_EQ(seen.at<float>(27, 35), 1.5F);
}

}  // namespace
}  // namespace dkp_slam

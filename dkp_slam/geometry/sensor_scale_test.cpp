#include "dkp_slam/geometry/sensor_scale.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

Camera camera_of(int width, double rate) {
  Camera camera;
  camera.fx = camera.fy = 520.0;
  camera.cx = 318.6;
  camera.cy = 255.3;
  camera.frame_rate = rate;
  return resized(camera, width, width * 3 / 4);
}

TEST(SensorScale, IsOneForTheUsualCameraWhateverItsLens) {
  Camera wide = camera_of(640, 30.0);
  wide.fx = 300.0;
  EXPECT_EQ(SensorScale::of(wide).pixels, 1.0);
  EXPECT_EQ(SensorScale::of(wide).frames, 1.0);
}

TEST(SensorScale, FollowsWidthAndRate) {
  const SensorScale slow = SensorScale::of(camera_of(320, 15.0));
  EXPECT_DOUBLE_EQ(slow.pixels, 0.5);
  EXPECT_EQ(slow.frames_of(6), 3);
  EXPECT_EQ(slow.frames_of(1), 1);  // never none
  EXPECT_DOUBLE_EQ(slow.per_frame(0.01), 0.02);
  const SensorScale fast = SensorScale::of(camera_of(1280, 60.0));
  EXPECT_DOUBLE_EQ(fast.pixels, 2.0);
  EXPECT_EQ(fast.frames_of(6), 12);
}

TEST(SensorScale, AResizedCameraSeesTheSame) {
  const Camera camera = camera_of(640, 30.0);
  const Eigen::Vector3d point(0.3, -0.2, 1.7);
  // Where the point lies from the image's left and upper border, as a share of its width.
  const auto place = [&](const Camera& c) -> Eigen::Vector2d {
    return (c.project(point).array() + 0.5) / c.width;
  };
  const Camera half = resized(camera, 320, 240), wide = resized(camera, 1280, 720);
  EXPECT_TRUE(place(half).isApprox(place(camera), 1e-12));
  EXPECT_NEAR(place(wide).x(), place(camera).x(), 1e-12);
  // 960 rows would show all: 120 are cut off above and below.
  EXPECT_NEAR(place(wide).y() + 120.0 / 1280, place(camera).y(), 1e-12);
  EXPECT_EQ(wide.height, 720);
}

}  // namespace
}  // namespace dkp_slam

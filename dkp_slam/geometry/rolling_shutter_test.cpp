#include "dkp_slam/geometry/rolling_shutter.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

Camera rolling_camera() {
  Camera camera;
  camera.fx = camera.fy = 500.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.readout = 0.02;
  return camera;
}

Vector6d velocity(double x, double y, double z, double turn_x, double turn_y, double turn_z) {
  Vector6d v;
  v << x, y, z, turn_x, turn_y, turn_z;
  return v;
}

/// What a camera with that velocity sees at a row's moment of what lies at `middle` at the middle
/// row's.
Eigen::Vector2d seen(const Camera& camera, const Eigen::Vector3d& middle, const Vector6d& v,
                     double row) {
  return camera.project(Se3::exp(row_delay(camera, row) * v) * middle);
}

TEST(RollingShutter, MiddleRowStaysAndRowsAreReadFromTopToBottom) {
  const Camera camera = rolling_camera();
  EXPECT_DOUBLE_EQ(row_delay(camera, 240.0), 0.0);
  EXPECT_DOUBLE_EQ(row_delay(camera, 0.0), -0.01);
  EXPECT_DOUBLE_EQ(row_delay(camera, 480.0), 0.01);
  const cv::Point2f pixel(100.0F, 240.0F);
  const ImagePoint there = at_middle_row(camera, {pixel, 2.0F}, 240.0F, velocity(1, 1, 1, 1, 1, 1));
  EXPECT_EQ(there.pixel, pixel);
  EXPECT_EQ(there.depth, 2.0F);
}

TEST(RollingShutter, ATurnMovesTopAndBottomApart) {
  // 1 rad/s about the vertical axis, at the image's middle column: 500 px * 1 rad/s * 10 ms.
  const Camera camera = rolling_camera();
  const Vector6d turn = velocity(0, 0, 0, 0, 1.0, 0);
  EXPECT_NEAR(at_middle_row(camera, {{320.0F, 0.0F}, 2.0F}, 0.0F, turn).pixel.x, 325.0F, 0.05F);
  EXPECT_NEAR(at_middle_row(camera, {{320.0F, 480.0F}, 2.0F}, 480.0F, turn).pixel.x, 315.0F, 0.05F);
}

TEST(RollingShutter, UndoesWhatTheMovingCameraSaw) {
  const Camera camera = rolling_camera();
  const Vector6d v = velocity(0.5, -0.3, 0.2, 0.6, -0.8, 0.4);
  for (const double row : {10.0, 120.0, 300.0, 470.0}) {
    const Eigen::Vector3d middle = camera.unproject({200.0, row}, 1.5);
    const Eigen::Vector2d p = seen(camera, middle, v, row);
    const float depth = static_cast<float>((Se3::exp(row_delay(camera, row) * v) * middle).z());
    const ImagePoint back =
        at_middle_row(camera, {{float(p.x()), float(p.y())}, depth}, float(row), v);
    EXPECT_GT((p - Eigen::Vector2d(200.0, row)).norm(), row == 240.0 ? 0.0 : 0.5) << row;
    EXPECT_NEAR(back.pixel.x, 200.0, 0.1) << row;
    EXPECT_NEAR(back.pixel.y, row, 0.1) << row;
    EXPECT_NEAR(back.depth, 1.5, 2e-4) << row;
  }
}

TEST(RollingShutter, UnknownDepthIsTakenAsFar) {
  // 1 m/s sideways at 10 ms moves a point 8 m away by 500 * 0.01 / 8 px.
  const ImagePoint p =
      at_middle_row(rolling_camera(), {{320.0F, 480.0F}, 0.0F}, 480.0F, velocity(1, 0, 1, 0, 0, 0));
  EXPECT_NEAR(p.pixel.x, 320.0F - 0.625F, 0.001F);
  EXPECT_EQ(p.depth, 0.0F);
}

}  // namespace
}  // namespace dkp_slam

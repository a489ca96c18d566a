#include "dkp_slam/geometry/camera.h"

#include <limits>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

namespace dkp_slam {
namespace {

Camera freiburg1() {
  Camera camera;
  camera.fx = 517.3;
  camera.fy = 516.5;
  camera.cx = 318.6;
  camera.cy = 255.3;
  camera.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  return camera;
}

TEST(Camera, UnprojectInvertsProject) {
  const Camera camera = freiburg1();
  const Eigen::Vector3d point(0.3, -0.2, 1.7);
  EXPECT_TRUE(camera.unproject(camera.project(point), point.z()).isApprox(point, 1e-12));
}

TEST(Camera, DistortAgreesWithOpenCv) {
  const Camera camera = freiburg1();
  const Eigen::Vector3d point(-0.4, 0.3, 1.2);
  std::vector<cv::Point2d> expected;
  cv::projectPoints(std::vector<cv::Point3d>{{point.x(), point.y(), point.z()}}, cv::Vec3d(),
                    cv::Vec3d(), camera.matrix(),
                    cv::Vec<double, 5>(0.2624, -0.9531, -0.0054, 0.0026, 1.1633), expected);
  const Eigen::Vector2d raw = camera.distort(camera.project(point));
  EXPECT_NEAR(raw.x(), expected[0].x, 1e-9);
  EXPECT_NEAR(raw.y(), expected[0].y, 1e-9);
}

TEST(Camera, UndistortInvertsDistortOverTheWholeImage) {
  const Camera camera = freiburg1();
  for (float v = 0; v < 480; v += 40) {
    for (float u = 0; u < 640; u += 40) {
      const cv::Point2f ideal = camera.undistort({{u, v}})[0];
      const Eigen::Vector2d back = camera.distort({ideal.x, ideal.y});
      EXPECT_NEAR(back.x(), u, 2e-3) << u << ' ' << v;
      EXPECT_NEAR(back.y(), v, 2e-3) << u << ' ' << v;
    }
  }
}

TEST(Camera, CheckNamesTheBadParameter) {
  EXPECT_FALSE(freiburg1().check());
  Camera camera = freiburg1();
  camera.fx = 0.0;
  EXPECT_NE(camera.check().value_or("").find("fx"), std::string::npos);
  camera = freiburg1();
  camera.distortion.k2 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(camera.check().value_or("").find("distortion"), std::string::npos);
  camera = freiburg1();
  camera.min_depth = 9.0;
  EXPECT_NE(camera.check().value_or("").find("min_depth"), std::string::npos);
}

}  // namespace
}  // namespace dkp_slam

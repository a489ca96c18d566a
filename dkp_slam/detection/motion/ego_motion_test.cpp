#include "dkp_slam/detection/motion/ego_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/motion/test_camera.h"
#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {
namespace {

constexpr double frame_seconds = 1.0 / 30.0;
constexpr double degree = std::numbers::pi / 180.0;

Camera rolling_camera() {
  Camera camera = test_camera();
  camera.readout = 0.03;
  return camera;
}

/// Where a hand has turned to, back and forth once a second: radians about the camera's y axis.
double turned_to(double seconds) { return 0.2 * std::sin(2.0 * std::numbers::pi * seconds); }

/// Walls from 1.2 to 3.8 m with a pattern on their lower half, seen by a camera that turns while it
/// reads its rows. (A turn before a wall of one depth would look like a shift.)
class TurningCamera {
 public:
  TurningCamera() : pattern_(400, 1200, CV_8UC1) {
    cv::RNG random(7);
    random.fill(pattern_, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(pattern_, pattern_, {0, 0}, 2.5);
    cv::normalize(pattern_, pattern_, 20, 235, cv::NORM_MINMAX);
  }

  void shoot(double seconds, cv::Mat& grey, cv::Mat& depth) const {
    const Camera camera = rolling_camera();
    cv::Mat places(camera.height, camera.width, CV_32FC2);
    depth.create(camera.height, camera.width, CV_32FC1);
    for (int v = 0; v < camera.height; ++v) {
      const double angle = turned_to(seconds + row_delay(camera, v));
      for (int u = 0; u < camera.width; ++u) {
        const double rx = (u - camera.cx) / camera.fx, ry = (v - camera.cy) / camera.fy;
        const double direction = angle + std::atan(rx), length = std::hypot(rx, 1.0);
        const double distance = 2.5 + 1.3 * std::sin(4.0 * direction);  // along the ground
        depth.at<float>(v, u) = static_cast<float>(distance / length);
        constexpr double texels = 300.0;  // a radian
        places.at<cv::Vec2f>(v, u) = {static_cast<float>(600.0 + texels * direction),
                                      static_cast<float>(std::max(0.0, texels * ry / length))};
      }
    }
    cv::remap(pattern_, grey, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    grey.rowRange(0, camera.height / 2).setTo(128);
  }

 private:
  cv::Mat pattern_;
};

/// The largest error of a turn from frame to frame, in degrees, over a second.
double worst_turn(const Camera& camera) {
  const TurningCamera world;
  EgoMotionEstimator estimator(camera);
  const cv::Mat trust(1, 1, CV_32FC1, cv::Scalar(1.0));
  double worst = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double seconds = i * frame_seconds;
    cv::Mat grey, depth;
    world.shoot(seconds, grey, depth);
    const EgoMotion motion = estimator.update(grey, depth, trust, frame_seconds);
    if (i < 3) continue;  // how the motion changes takes three frames to be known
    EXPECT_TRUE(motion.valid) << "frame " << i;
    const double truth = turned_to(seconds) - turned_to(seconds - frame_seconds);
    // A camera that turns by a sees points turned by -a.
    const double found = -2.0 * std::atan2(motion.current_from_previous.rotation.y(),
                                           motion.current_from_previous.rotation.w());
    worst = std::max(worst, std::abs(found - truth) / degree);
  }
  return worst;
}

TEST(EgoMotion, EveryRowHasItsMoment) {
  Camera global = rolling_camera();
  global.readout = 0.0;
  EXPECT_LT(worst_turn(rolling_camera()), 0.05);
  EXPECT_GT(worst_turn(global), 0.06);
}

TEST(EgoMotion, TellsVelocitiesAtBothFrames) {
  const TurningCamera world;
  EgoMotionEstimator estimator(rolling_camera());
  const cv::Mat trust(1, 1, CV_32FC1, cv::Scalar(1.0));
  for (int i = 0; i < 10; ++i) {
    const double seconds = i * frame_seconds;
    cv::Mat grey, depth;
    world.shoot(seconds, grey, depth);
    const EgoMotion motion = estimator.update(grey, depth, trust, frame_seconds);
    if (i < 3) continue;
    const auto rate = [](double at) {
      return -2.0 * std::numbers::pi * 0.2 * std::cos(2.0 * std::numbers::pi * at);
    };
    EXPECT_NEAR(motion.velocity[4], rate(seconds), 0.06) << "frame " << i;
    EXPECT_NEAR(motion.previous_velocity[4], rate(seconds - frame_seconds), 0.06) << "frame " << i;
  }
}

TEST(EgoMotion, SaysNothingOfTheFirstFrameNorOfABlankOne) {
  EgoMotionEstimator estimator(rolling_camera());
  const cv::Mat trust(1, 1, CV_32FC1, cv::Scalar(1.0));
  cv::Mat grey, depth;
  TurningCamera().shoot(0.0, grey, depth);
  EXPECT_FALSE(estimator.update(grey, depth, trust, 0.0).valid);
  EXPECT_TRUE(estimator.update(grey, depth, trust, frame_seconds).valid);
  EXPECT_FALSE(
      estimator.update(cv::Mat::zeros(grey.size(), CV_8UC1), depth, trust, frame_seconds).valid);
}

}  // namespace
}  // namespace dkp_slam

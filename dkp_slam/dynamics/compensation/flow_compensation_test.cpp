#include "dkp_slam/dynamics/compensation/flow_compensation.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

cv::Mat texture() {
  cv::RNG random(1);
  cv::Mat noise(480, 640, CV_8UC1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 2.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise;
}

constexpr float person_right = 200.0F;  // who was dynamic lies left of it, pixels
constexpr int shift = 3;                // pixels to the right from the first frame to the second

/// A wall 3 m off that moves 3 px to the right in the image, but for a band of rows that does not.
class Missed : public ::testing::Test {
 protected:
  void SetUp() override {
    const cv::Mat before = texture();
    cv::Mat now;
    cv::warpAffine(before, now, cv::Matx23d(1, 0, shift, 0, 1, 0), before.size());
    before.rowRange(200, 260).copyTo(now.rowRange(200, 260));
    for (int y = 30; y < 460; y += 20) {
      for (int x = 40; x < 620; x += 20) points_.emplace_back(float(x), float(y));
    }
    estimator_.track(before, depth_, points_, {}, {}, 0.0);
    motion_ = estimator_.track(now, depth_, points_, {}, {}, 1 / 30.0);
  }
  void remember() {
    std::vector<std::uint8_t> is_static;
    for (const cv::Point2f& p : points_) is_static.push_back(p.x < person_right ? 0 : 1);
    compensation_.remember(points_, is_static);
  }

  cv::Mat depth_ = cv::Mat(480, 640, CV_32FC1, cv::Scalar(3.0F));
  std::vector<cv::Point2f> points_;
  FeatureMotionEstimator estimator_{testing::vga_camera(), {}};
  FeatureMotion motion_;
  FlowCompensation compensation_{MotionOptions{}};
};

TEST_F(Missed, DropsWhatWasDynamicAndWhatRansacRejects) {
  remember();
  const auto found = compensation_.compensate(depth_, points_, 1, estimator_, motion_);
  int kept = 0, wanted = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const cv::Point2f& p = points_[i];
    const bool at_seam = std::abs(p.y - 200.0F) < 15.0F || std::abs(p.y - 260.0F) < 15.0F;
    if (at_seam) continue;
    if (p.x < person_right || (p.y > 200.0F && p.y < 260.0F)) {
      EXPECT_EQ(found.is_static[i], 0) << p;
    } else {
      ++wanted;
      kept += found.is_static[i];
    }
  }
  EXPECT_GT(kept, 0.95 * wanted);
}

TEST_F(Missed, TellsThePoseFromWhatIsLeft) {
  remember();
  const auto found = compensation_.compensate(depth_, points_, 1, estimator_, motion_);
  ASSERT_TRUE(found.current_from_previous.has_value());
  // Where the wall moves 3 px to the right, the camera turned or slid to the left by as much.
  const Eigen::Vector3d middle = *found.current_from_previous * Eigen::Vector3d(0, 0, 3);
  EXPECT_NEAR(525.0 * middle.x() / middle.z(), shift, 0.2);
  EXPECT_NEAR(525.0 * middle.y() / middle.z(), 0.0, 0.2);
}

TEST_F(Missed, WithoutAFrameBeforeAllTrackedFeaturesCount) {
  const auto found = compensation_.compensate(depth_, points_, 1, estimator_, motion_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].x < person_right && points_[i].y < 180.0F && points_[i].y > 60.0F) {
      EXPECT_EQ(found.is_static[i], motion_.tracks.tracked[i]);
    }
  }
}

}  // namespace
}  // namespace dkp_slam

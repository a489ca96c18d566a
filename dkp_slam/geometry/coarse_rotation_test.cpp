#include "dkp_slam/geometry/coarse_rotation.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/se3.h"
#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// Patches of all sizes, painted on a sphere about the camera and seen after it has turned.
cv::Mat view(const Camera& camera, const Eigen::Quaterniond& world_from_camera) {
  cv::Mat pattern(600, 1200, CV_8UC1);
  cv::RNG random(4);
  random.fill(pattern, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(pattern, pattern, {}, 12.0);
  cv::normalize(pattern, pattern, 0, 255, cv::NORM_MINMAX);
  cv::Mat x(camera.height, camera.width, CV_32F), y = x.clone(), grey;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray =
          world_from_camera * camera.unproject({double(u), double(v)}, 1.0).normalized();
      constexpr double per_radian = 400.0;
      x.at<float>(v, u) = static_cast<float>(600.0 + per_radian * std::atan2(ray.x(), ray.z()));
      y.at<float>(v, u) = static_cast<float>(300.0 + per_radian * std::asin(ray.y()));
    }
  }
  cv::remap(pattern, grey, x, y, cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  return grey;
}

Eigen::Quaterniond turned(double x, double y, double z) {
  Vector6d tangent;
  tangent << 0.0, 0.0, 0.0, x * degree, y * degree, z * degree;
  return Se3::exp(tangent).rotation;
}

double off(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) / degree;
}

TEST(CoarseRotation, FindsTurnsOfAnyAxis) {
  const Camera camera = testing::vga_camera();
  for (const auto& turn : {turned(0, 0, 0), turned(1, -2, 0.5), turned(-0.4, 6, -1),
                           turned(4, 1, 3), turned(0, -6, 0)}) {
    CoarseRotation rotation(camera);
    EXPECT_FALSE(rotation.previous_from_current().has_value());
    rotation.push(view(camera, Eigen::Quaterniond::Identity()), {});
    rotation.push(view(camera, turn), {});
    const auto found = rotation.previous_from_current();
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(off(*found, turn), 0.1);
  }
}

TEST(CoarseRotation, DoesNotFollowWhatIsHidden) {
  const Camera camera = testing::vga_camera();
  const auto turn = turned(0.5, 3, 0);
  const cv::Rect person(150, 0, 400, 480);  // 60% of the view, and it stays where it is in it
  cv::Mat before = view(camera, Eigen::Quaterniond::Identity()), now = view(camera, turn);
  view(camera, turned(0, 40, 0))(person).copyTo(before(person));
  before(person).copyTo(now(person));
  const auto error_with = [&](const std::vector<cv::Rect2f>& hidden) {
    CoarseRotation rotation(camera);
    rotation.push(before, hidden);
    rotation.push(now, hidden);
    const auto found = rotation.previous_from_current();
    EXPECT_TRUE(found.has_value());
    return found ? off(*found, turn) : 90.0;
  };
  EXPECT_LT(error_with({cv::Rect2f(person)}), 0.2);
  EXPECT_GT(error_with({}), 1.0);
}

TEST(CoarseRotation, SaysNothingWhenAllIsHidden) {
  const Camera camera = testing::vga_camera();
  CoarseRotation rotation(camera);
  for (int i = 0; i < 2; ++i) {
    rotation.push(view(camera, turned(0, i, 0)), {cv::Rect2f(0.0F, 0.0F, 620.0F, 480.0F)});
  }
  EXPECT_FALSE(rotation.previous_from_current().has_value());
}

TEST(CoarseRotation, LampsThatChangeTurnNothing) {
  const Camera camera = testing::vga_camera();
  const auto turn = turned(0, 2, 0);
  CoarseRotation rotation(camera);
  rotation.push(view(camera, Eigen::Quaterniond::Identity()), {});
  rotation.push(view(camera, turn) - 25, {});
  const auto found = rotation.previous_from_current();
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(off(*found, turn), 0.2);
}

}  // namespace
}  // namespace dkp_slam

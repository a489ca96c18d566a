#include "dkp_slam/synth/mesh/texture.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using Eigen::Vector2d;

const Vector2d tiny(1e-4, 0.0), tiny_down(0.0, 1e-4);

TEST(Texture, InterpolatesBetweenTexelCentres) {
  cv::Mat image(1, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {0, 100, 10};
  image.at<cv::Vec3b>(0, 1) = {200, 100, 20};
  const Texture texture(image);
  EXPECT_FLOAT_EQ(texture.sample({0.25, 0.5}, tiny, tiny_down)[0], 0.0F);
  EXPECT_FLOAT_EQ(texture.sample({0.50, 0.5}, tiny, tiny_down)[0], 100.0F);
  EXPECT_FLOAT_EQ(texture.sample({0.75, 0.5}, tiny, tiny_down)[0], 200.0F);
  EXPECT_FLOAT_EQ(texture.sample({1.0, 0.5}, tiny, tiny_down)[0], 200.0F);               // clamped
  EXPECT_FLOAT_EQ(Texture(image, true).sample({1.0, 0.5}, tiny, tiny_down)[0], 100.0F);  // wrapped
}

TEST(Texture, FineChecksFarAwayAreGrey) {
  cv::Mat image(64, 64, CV_8UC3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      image.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x + y) % 2 == 0 ? 200 : 100);
    }
  }
  const Texture texture(image);
  for (const double at : {0.31, 0.4127, 0.5, 0.777}) {
    // A pixel that covers eight texels each way.
    const cv::Vec3f seen =
        texture.sample(Vector2d(at, 1.0 - at), Vector2d(8.0 / 64, 0.0), Vector2d(0.0, 8.0 / 64));
    EXPECT_NEAR(seen[0], 150.0, 1.0);
  }
}

TEST(Texture, StripesSurviveASlantAlongThem) {
  // Vertical stripes 8 texels wide; the footprint is long along them and narrow across.
  cv::Mat image(64, 64, CV_8UC3);
  for (int x = 0; x < 64; ++x) image.col(x).setTo(cv::Scalar::all(x / 8 % 2 == 0 ? 200 : 100));
  const Texture texture(image);
  const Vector2d across(1.0 / 64, 0.0), along(0.0, 6.0 / 64);
  EXPECT_NEAR(texture.sample({4.0 / 64, 0.5}, across, along)[0], 200.0, 1.0);
  EXPECT_NEAR(texture.sample({12.0 / 64, 0.5}, across, along)[0], 100.0, 1.0);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/geometry/depth_correction.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

const cv::Size image(64, 48);

TEST(DepthDistortion, TermsGoFromMinusOneToOneOverTheImage) {
  const auto corner = DepthDistortion::terms({0.0, 0.0}, image);
  const auto middle = DepthDistortion::terms({32.0, 24.0}, image);
  const auto side = DepthDistortion::terms({48.0, 24.0}, image);
  EXPECT_EQ(corner.transpose(),
            (Eigen::Matrix<double, 1, 9>() << -1, -1, 1, 1, 1, -1, -1, -1, -1).finished());
  EXPECT_TRUE(middle.isZero(0.0));
  EXPECT_EQ(side.transpose(),
            (Eigen::Matrix<double, 1, 9>() << 0.5, 0, 0.25, 0, 0, 0.125, 0, 0, 0).finished());
}

TEST(DepthCorrector, AddsToTheInverseOfKnownDepths) {
  DepthCorrection correction;
  correction.distortion.coefficients << 0.02, 0, 0, 0, 0, 0, 0, 0, 0;
  correction.bias = 0.5;
  cv::Mat depth(image, CV_32FC1, cv::Scalar(2.0));
  depth.at<float>(10, 48) = 0.0F;
  DepthCorrector(correction, image).apply(depth);
  EXPECT_FLOAT_EQ(depth.at<float>(24, 32), 2.5F) << "nothing in the middle";
  EXPECT_FLOAT_EQ(depth.at<float>(24, 0), 1.0F / (0.5F - 0.02F) + 0.5F);
  EXPECT_FLOAT_EQ(depth.at<float>(24, 48), 1.0F / (0.5F + 0.01F) + 0.5F);
  EXPECT_EQ(depth.at<float>(10, 48), 0.0F) << "unknown stays unknown";
}

TEST(DepthCorrector, ForgetsWhatWouldMoreThanDouble) {
  DepthCorrection correction;
  correction.distortion.coefficients << 0.05, 0, 0, 0, 0, 0, 0, 0, 0;
  cv::Mat depth(image, CV_32FC1, cv::Scalar(30.0));
  DepthCorrector(correction, image).apply(depth);
  EXPECT_EQ(depth.at<float>(5, 0), 0.0F);
  EXPECT_FLOAT_EQ(depth.at<float>(5, 32), 30.0F);
  EXPECT_FLOAT_EQ(depth.at<float>(5, 48), 30.0F / 1.75F);
}

TEST(DepthCorrector, ChangesNothingUnlessTold) {
  cv::Mat depth(image, CV_32FC1, cv::Scalar(3.0));
  const cv::Mat before = depth.clone();
  DepthCorrector().apply(depth);
  DepthCorrector({.delay = 0.01}, image).apply(depth);
  EXPECT_EQ(cv::norm(depth, before, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace dkp_slam

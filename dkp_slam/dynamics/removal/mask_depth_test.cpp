#include "dkp_slam/dynamics/removal/mask_depth.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// A mask of 10 x 10 pixels from (20, 20) on, all of it 2 m away, the rest 3 m.
class MaskDepthOfASquare : public ::testing::Test {
 protected:
  MaskDepthOfASquare() {
    masks_(square_) = 255;
    depth_.setTo(3.0F);
    depth_(square_) = 2.0F;
  }
  bool shared(cv::Point pixel, int reach = 4, double tolerance = 0.05) const {
    return MaskDepth(reach, tolerance).is_shared(masks_, depth_, pixel);
  }

  const cv::Rect square_{20, 20, 10, 10};
  cv::Mat masks_ = cv::Mat::zeros(48, 64, CV_8UC1);
  cv::Mat depth_ = cv::Mat(48, 64, CV_32FC1);
};

TEST_F(MaskDepthOfASquare, IsToldWithinReachAndTolerance) {
  EXPECT_FALSE(shared({33, 25}));
  depth_.at<float>(25, 33) = 2.0F;
  EXPECT_TRUE(shared({33, 25}));
  EXPECT_FALSE(shared({33, 25}, 3));  // the mask's last column is 29
  depth_.at<float>(25, 33) = 2.1F;
  EXPECT_TRUE(shared({33, 25}));
  depth_.at<float>(25, 33) = 2.11F;
  EXPECT_FALSE(shared({33, 25}));
  EXPECT_TRUE(shared({33, 25}, 4, 0.06));
}

TEST_F(MaskDepthOfASquare, IsThatOfTheNearestPixelThatHasOne) {
  depth_.at<float>(25, 33) = 2.5F;
  depth_.at<float>(25, 28) = 2.5F;
  EXPECT_FALSE(shared({33, 25}, 6));  // (29, 25) is nearer, and 2 m away
  depth_(cv::Rect(29, 20, 1, 10)) = 0.0F;
  EXPECT_TRUE(shared({33, 25}, 6));
}

TEST_F(MaskDepthOfASquare, IsNotToldWhereDepthIsUnknown) {
  depth_.at<float>(25, 32) = 0.0F;
  EXPECT_FALSE(shared({32, 25}));
  depth_.at<float>(25, 32) = 2.0F;
  depth_(square_) = 0.0F;
  EXPECT_FALSE(shared({32, 25}));
}

TEST_F(MaskDepthOfASquare, EndsWithTheImage) {
  masks_(cv::Rect(60, 0, 4, 4)) = 255;
  EXPECT_TRUE(shared({59, 0}));  // all of it is 3 m away
  EXPECT_FALSE(shared({0, 47}));
}

TEST_F(MaskDepthOfASquare, CandidatesAreWithinReach) {
  const cv::Mat candidates = MaskDepth(4, 0.05).candidates(masks_);
  EXPECT_EQ(cv::countNonZero(candidates), 18 * 18);
  EXPECT_NE(candidates.at<std::uint8_t>(16, 33), 0);
  EXPECT_EQ(candidates.at<std::uint8_t>(15, 33), 0);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/detection/startle.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// A wall at 3 m, and before it, over the left `share` of the image, somebody at `z` metres.
cv::Mat room(double share, float z = 1.0F) {
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0));
  depth.colRange(0, static_cast<int>(share * depth.cols)).setTo(z);
  return depth;
}

/// One that has seen `depth` for the tenth of a second until 0.
Startle used_to(const cv::Mat& depth) {
  Startle startle;
  for (const double time : {-0.1, -0.067, -0.033, 0.0}) startle.by(time, depth);
  return startle;
}

TEST(Startle, SomebodyWhoStepsIn) {
  Startle startle = used_to(room(0.0));
  cv::Mat hand = room(0.0);
  hand(cv::Rect(300, 200, 60, 60)).setTo(1.0);  // a hundredth
  EXPECT_FALSE(startle.by(0.033, hand));
  EXPECT_TRUE(startle.by(0.067, room(0.2)));
  EXPECT_TRUE(startle.by(0.1, room(0.2)));     // a colour image may be late
  EXPECT_FALSE(startle.by(0.167, room(0.2)));  // who is there already
  EXPECT_FALSE(startle.by(0.2, room(0.0)));    // or leaves
}

/// Posts at 1 m before a wall at 3 m, by up to 30 pixels from where they were.
TEST(Startle, WhatATurningCameraMovesIsNobody) {
  const auto turned = [](int pixels) {
    cv::Mat depth = room(0.0);
    for (int x = 0; x < depth.cols; x += 80) {
      depth.colRange(x + pixels, x + pixels + 40).setTo(1.0);
    }
    return depth;
  };
  Startle startle = used_to(turned(0));
  for (int i = 1; i <= 10; ++i) EXPECT_FALSE(startle.by(i / 30.0, turned(i % 2 == 0 ? 0 : 30)));
}

TEST(Startle, ImagesOfOtherSizes) {
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(1280, 720), cv::Size(24, 18)}) {
    const auto resized = [&size](const cv::Mat& depth) {
      cv::Mat other;
      cv::resize(depth, other, size, 0, 0, cv::INTER_NEAREST);
      return other;
    };
    Startle startle = used_to(resized(room(0.0)));
    EXPECT_FALSE(startle.by(0.033, resized(room(0.0)))) << size;
    EXPECT_TRUE(startle.by(0.067, resized(room(0.2)))) << size;
  }
}

TEST(Startle, TheShareThatIsGiven) {
  for (const double least : {0.1, 0.3}) {
    Startle startle(least);
    for (const double time : {-0.1, -0.067, -0.033, 0.0}) startle.by(time, room(0.0));
    EXPECT_EQ(startle.by(0.033, room(0.2)), least < 0.2);
  }
}

TEST(Startle, ACameraThatMovesOrHasNoDepthIsNobody) {
  Startle startle = used_to(room(1.0, 3.0F));
  EXPECT_FALSE(startle.by(0.033, room(1.0, 2.9F)));
  EXPECT_FALSE(startle.by(0.067, room(1.0, 0.0F)));
  EXPECT_FALSE(startle.by(0.1, room(1.0, 1.0F)));  // depth that was not known before
  EXPECT_FALSE(startle.by(0.133, {}));
  EXPECT_FALSE(startle.by(0.167, room(0.5)));
}

TEST(Startle, TheFirstImageAndThoseAfterAGap) {
  Startle startle;
  for (const double first : {10.0, 10.4, 9.0}) {  // after a gap, and after the clock was set back
    EXPECT_TRUE(startle.by(first, room(0.0)));
    EXPECT_TRUE(startle.by(first + 0.033, room(0.0)));
    EXPECT_FALSE(startle.by(first + 0.1, room(0.0)));
    EXPECT_TRUE(startle.by(first + 0.133, room(0.3)));
    EXPECT_TRUE(startle.by(first + 0.167, room(0.3)));
    EXPECT_FALSE(startle.by(first + 0.217, room(0.3)));
  }
}

}  // namespace
}  // namespace dkp_slam

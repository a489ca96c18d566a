#include "dkp_slam/dynamics/masks/mask_depth_choice.h"

#include <vector>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

const cv::Size size(640, 480);
constexpr int bright = 200;

/// Somebody's silhouette, 120 pixels wide and 240 high.
cv::Mat somebody(int left, int value) {
  cv::Mat image = cv::Mat::zeros(size, CV_8UC1);
  image(cv::Rect(left, 100, 120, 240)) = value;
  return image;
}

TEST(OutlineGradients, AreThoseOfTheImageWhereTheOutlinesLieApart) {
  const cv::Mat grey = somebody(200, bright);
  const OutlineGradients g = outline_gradients(grey, somebody(200, 1), somebody(230, 1));
  // Of each the two upright sides, and 15 pixels of the view of its top and its bottom.
  EXPECT_NEAR(g.pixels, 2 * (120 + 15), 8);
  EXPECT_NEAR(g.first, bright / 2.0, 3.0) << "central differences across a step";
  EXPECT_LT(g.second, 3.0);
}

TEST(OutlineGradients, AreOfNothingWhereTheOutlinesAgree) {
  const cv::Mat grey = somebody(200, bright);
  EXPECT_EQ(outline_gradients(grey, somebody(200, 1), somebody(200, 255)).pixels, 0);
  EXPECT_EQ(outline_gradients(grey, somebody(200, 1), somebody(202, 1)).pixels, 0)
      << "two pixels are one of the view";
  EXPECT_EQ(outline_gradients(grey, somebody(200, 1), somebody(0, 0)).pixels, 0);
  const cv::Mat whole(size, CV_8UC1, cv::Scalar(1));
  EXPECT_EQ(outline_gradients(grey, somebody(200, 1), whole).pixels, 0)
      << "the image's edge is no outline";
}

TEST(MaskDepthChoice, IsOfTheImageWhoseOutlinesLieWhereTheImageChanges) {
  MaskDepthChoice choice({});
  EXPECT_FALSE(choice.stamped());
  const cv::Mat grey = somebody(200, bright);
  for (int i = 0; i < 10; ++i) choice.compare(grey, somebody(200, 1), somebody(200, 1));
  EXPECT_FALSE(choice.stamped()) << "they are the same";
  choice.compare(grey, somebody(215, 1), somebody(200, 1));
  EXPECT_TRUE(choice.stamped());
  for (int i = 0; i < 40; ++i) choice.compare(grey, somebody(200, 1), somebody(215, 1));
  EXPECT_FALSE(choice.stamped()) << "somebody else may have come";
}

TEST(MaskDepthChoice, StaysWhereNothingTells) {
  MaskDepthChoice choice({});
  const cv::Mat flat(size, CV_8UC1, cv::Scalar(bright));
  for (int i = 0; i < 40; ++i) choice.compare(flat, somebody(200, 1), somebody(215, 1));
  EXPECT_FALSE(choice.stamped());
  choice.compare(somebody(200, bright), somebody(215, 1), somebody(200, 1));
  choice.compare(somebody(200, bright), somebody(215, 1), somebody(200, 1));
  EXPECT_TRUE(choice.stamped());
  for (int i = 0; i < 40; ++i) choice.compare(flat, somebody(200, 1), somebody(215, 1));
  EXPECT_TRUE(choice.stamped());
}

TEST(MaskDepthChoice, IsAskedForEveryFewFramesOrNever) {
  MaskDepthOptions options;
  options.every = 3;
  MaskDepthChoice choice(options);
  std::vector<bool> asked;
  for (int i = 0; i < 5; ++i) asked.push_back(choice.wants_comparison());
  EXPECT_EQ(asked, (std::vector<bool>{true, false, false, true, false}));
  // Half as often once there is no doubt.
  const cv::Mat grey = somebody(200, bright);
  for (int i = 0; i < 10; ++i) choice.compare(grey, somebody(215, 1), somebody(200, 1));
  int comparisons = 0;
  for (int i = 0; i < 60; ++i) comparisons += choice.wants_comparison();
  EXPECT_EQ(comparisons, 10);
  options.every = 0;
  MaskDepthChoice never(options);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(never.wants_comparison());
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/synth/true_detections.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(TrueDetections, HaveNamesBoxesAndSilhouettes) {
  SyntheticTruth truth;
  truth.instance = cv::Mat::zeros(100, 100, CV_8U);
  truth.instance(cv::Rect(10, 20, 30, 40)).setTo(1);
  truth.instance(cv::Rect(60, 20, 20, 20)).setTo(2);
  truth.instance(cv::Rect(5, 5, 3, 3)).setTo(3);
  truth.objects = {{1, "person", {10, 20, 30, 40}, 1200},
                   {2, "", {60, 20, 20, 20}, 400},
                   {3, "chair", {5, 5, 3, 3}, 9}};
  const auto found = true_detections(truth, {}, true);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box, cv::Rect2f(10, 20, 30, 40));
  EXPECT_EQ(cv::countNonZero(found[0].mask), 1200);
  EXPECT_FLOAT_EQ(found[0].weight, 10.0F);
}

}  // namespace
}  // namespace dkp_slam

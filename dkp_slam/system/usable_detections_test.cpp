#include "dkp_slam/system/usable_detections.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

const cv::Size image(160, 120);

Detection good() {
  Detection d;
  d.box = cv::Rect2f(10.25F, 20.125F, 30.0F, 40.0F);
  d.class_id = 0;
  d.score = 0.5F;
  d.mask = cv::Mat(41, 31, CV_8UC1, cv::Scalar(255));
  return d;
}

template <class Change>
std::vector<Detection> usable(Change change) {
  std::vector<Detection> both{good(), good()};
  change(both.front());
  return usable_detections(std::move(both), image);
}

TEST(UsableDetections, LeavesWhatIsRightAsItIs) {
  const auto all = usable([](Detection&) {});
  ASSERT_EQ(all.size(), 2U);
  for (const Detection& d : all) {
    EXPECT_EQ(d.box, good().box);
    EXPECT_EQ(d.mask.size(), good().mask.size());
  }
}

TEST(UsableDetections, DropsWhatIsNoDetection) {
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  for (const float wrong : {nan, infinite, -infinite}) {
    EXPECT_EQ(usable([&](Detection& d) { d.box.x = wrong; }).size(), 1U);
    EXPECT_EQ(usable([&](Detection& d) { d.box.width = wrong; }).size(), 1U);
    EXPECT_EQ(usable([&](Detection& d) { d.score = wrong; }).size(), 1U);
    EXPECT_EQ(usable([&](Detection& d) { d.weight = wrong; }).size(), 1U);
  }
  EXPECT_EQ(usable([&](Detection& d) { d.score = 1.5F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.score = -0.5F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.weight = 0.0F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.box.width = 0.0F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.box.height = -5.0F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.box.x = 160.0F; }).size(), 1U);
  EXPECT_EQ(usable([&](Detection& d) { d.box.y = -1e30F; }).size(), 1U);
}

TEST(UsableDetections, ClipsToTheImage) {
  const auto all = usable([](Detection& d) { d.box = cv::Rect2f(-10.0F, 100.0F, 50.0F, 1e20F); });
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all.front().box, cv::Rect2f(0.0F, 100.0F, 40.0F, 20.0F));
  EXPECT_TRUE(all.front().mask.empty());  // it no longer begins where the box does
}

TEST(UsableDetections, ASilhouetteOfAnotherTypeIsNone) {
  const auto all = usable([](Detection& d) { d.mask.convertTo(d.mask, CV_32F); });
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(all.front().mask.empty());
  EXPECT_EQ(all.front().box, good().box);
}

}  // namespace
}  // namespace dkp_slam

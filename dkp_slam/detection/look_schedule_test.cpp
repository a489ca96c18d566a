#include "dkp_slam/detection/look_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

const cv::Size image(640, 480);

Detection person(const cv::Rect2f& box, float weight = 10.0F, float score = 0.9F) {
  Detection d;
  d.box = box;
  d.weight = weight;
  d.score = score;
  return d;
}

/// Looks among `count` images at 30 Hz from `first` on, each of which shows `detections`.
int looks(LookSchedule& schedule, int first, int count, const std::vector<Detection>& detections) {
  int looked = 0;
  for (int i = first; i < first + count; ++i) {
    if (!schedule.due(100.0 + i / 30.0)) continue;
    schedule.saw(detections, image);
    ++looked;
  }
  return looked;
}

TEST(LookSchedule, LooksAtEveryImageAtTheStart) {
  LookSchedule schedule{LookOptions{}};
  EXPECT_EQ(looks(schedule, 0, 30, {}), 30);
}

TEST(LookSchedule, LooksAtEveryImageWherePeopleFillIt) {
  const std::vector<Detection> crowd{person({0, 0, 400, 480})};
  const std::vector<Detection> one{person({100, 100, 80, 200})};
  LookSchedule schedule{LookOptions{}};
  looks(schedule, 0, 30, {});
  EXPECT_NEAR(looks(schedule, 30, 60, {}), 30, 1);
  EXPECT_NEAR(looks(schedule, 90, 60, one), 30, 1);
  looks(schedule, 150, 2, crowd);  // sees them at the second image, at the latest
  EXPECT_EQ(looks(schedule, 152, 30, crowd), 30);
  looks(schedule, 182, 1, {});
  EXPECT_NEAR(looks(schedule, 183, 60, {}), 30, 1);
}

TEST(LookSchedule, ThingsAndWeakBoxesAreNobody) {
  LookSchedule schedule{LookOptions{}};
  looks(schedule, 0, 30, {});
  const std::vector<Detection> others{person({0, 0, 640, 480}, 2.0F),
                                      person({0, 0, 640, 480}, 10.0F, 0.12F)};
  EXPECT_NEAR(looks(schedule, 30, 60, others), 30, 1);
}

TEST(LookSchedule, BoxesBeyondTheImageCountInsideOnly) {
  LookSchedule schedule{LookOptions{}};
  schedule.due(0.0);
  schedule.saw({person({-100, -100, 1e4F, 1e4F}), person({630, 470, 500, 500})}, image);
  EXPECT_TRUE(schedule.due(0.001));
}

TEST(LookSchedule, GapsAndClocksThatAreSetBackAreLookedAtAtOnce) {
  LookSchedule schedule{LookOptions{}};
  std::vector<bool> due;
  for (const double t : {1.0, 5.0, 5.033, 5.067, 5.1, 8.0, 8.033, 1.2}) {
    due.push_back(schedule.due(t));
    if (due.back()) schedule.saw({}, image);
  }
  EXPECT_THAT(due, ::testing::ElementsAre(true, true, true, true, false, true, true, true));
}

TEST(LookSchedule, SomebodyWhoStepsIntoTheViewIsLookedAtAtOnce) {
  const cv::Mat room(480, 640, CV_32FC1, cv::Scalar(2.0F));
  const auto with_somebody = [&](float depth) {
    cv::Mat seen = room.clone();
    seen(cv::Rect(0, 100, 160, 380)) = depth;  // a fifth of the image
    return seen;
  };
  const auto asked = [&](const cv::Mat& next) {
    LookSchedule schedule{LookOptions{}};
    for (int i = 0; i < 30; ++i) {
      if (schedule.due(i / 30.0, room)) schedule.saw({}, image);
    }
    return schedule.due(1.0, next);  // the first that it passes over
  };
  EXPECT_FALSE(asked(room));
  EXPECT_TRUE(asked(with_somebody(1.0F)));
  EXPECT_FALSE(asked(with_somebody(3.0F))) << "somebody who leaves";
  EXPECT_FALSE(asked(with_somebody(0.0F))) << "unknown depth";
  EXPECT_FALSE(asked(room * 0.95F)) << "the camera goes forward";
  EXPECT_FALSE(asked(cv::Mat()));
}

TEST(LookSchedule, CanBeToldToLookAtEveryImage) {
  LookOptions options;
  options.interval = 0.0;
  LookSchedule schedule(options);
  EXPECT_EQ(looks(schedule, 0, 90, {}), 90);
}

}  // namespace
}  // namespace dkp_slam

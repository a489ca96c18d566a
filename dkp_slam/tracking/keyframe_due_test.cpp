// When a frame should become a keyframe.

#include <cmath>

#include <gtest/gtest.h>

#include "dkp_slam/tracking/test_tracking.h"

namespace dkp_slam {
namespace {

struct KeyframeDue : testing::Tracking {
  /// Whether a frame of the camera that stands still, in which this share of the points is tracked,
  /// asks for a keyframe. All are within 2.5 m: without depth no near features ask for one.
  bool due_with(int index, double tracked_share, bool adjusting) {
    Frame frame = frame_at({}, index);
    const auto fresh = static_cast<int>(std::lround((1.0 - tracked_share) * 300));
    forget_points(frame, fresh);
    for (int f = 0; f < fresh; ++f) frame.features.depth[static_cast<std::size_t>(f)] = 0.0F;
    const TrackingResult result = tracker().track(frame, adjusting);
    EXPECT_TRUE(result.localised);
    EXPECT_EQ(tracker().tracked_landmarks(), 300 - fresh);
    tracker().settle(frame, false);
    return result.keyframe_due;
  }
};

TEST_F(KeyframeDue, AKeyframeIsDueAfterTheInterval) {
  const int last = static_cast<int>(options.keyframe_interval * 30.0);
  for (int i = 0; i <= last; ++i) {
    Frame frame = frame_at({}, i);
    const TrackingResult result = track(frame);
    ASSERT_TRUE(result.localised);
    EXPECT_EQ(result.keyframe_due, i == 0 || i == last) << i;
  }
}

TEST_F(KeyframeDue, NoKeyframeIsDueByTimeWhileAnAdjustmentIsUnderWay) {
  for (int i = 0; i <= 40; ++i) {
    Frame frame = frame_at({}, i);
    EXPECT_EQ(track(frame, true).keyframe_due, i == 0);
  }
}

TEST_F(KeyframeDue, AKeyframeIsDueWhenFewOfTheReferencesLandmarksAreTracked) {
  options.left_share = 0.0;  // that rule is another test's
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const double share = options.keyframe_share, urgent = options.urgent_share;
  EXPECT_FALSE(due_with(1, share + 0.02, false));
  EXPECT_TRUE(due_with(2, share - 0.02, false));
  EXPECT_FALSE(due_with(3, share - 0.02, true));  // that can wait for the adjustment,
  EXPECT_FALSE(due_with(4, urgent + 0.02, true));
  EXPECT_TRUE(due_with(5, urgent - 0.02, true));  // and this cannot
}

TEST_F(KeyframeDue, AKeyframeIsDueWhereTheViewIsLeft) {
  options.keyframe_share = options.urgent_share = 0.0;  // those rules are another test's
  options.left_least = 300;                             // all that there are
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  EXPECT_FALSE(due_with(1, 1.0, false));
  EXPECT_FALSE(due_with(2, options.left_share + 0.02, false));
  EXPECT_TRUE(due_with(3, options.left_share - 0.02, false));
  // While the last one is adjusted: not in the next frames.
  EXPECT_FALSE(due_with(2, options.left_share - 0.02, true));
  EXPECT_TRUE(due_with(4, options.left_share - 0.02, true));
}

TEST_F(KeyframeDue, NoneIsDueForThatWhereFewWereTrackedInTheFirstPlace) {
  options.keyframe_share = options.urgent_share = 0.0;
  options.left_least = 301;
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  EXPECT_FALSE(due_with(1, 1.0, false));
  EXPECT_FALSE(due_with(3, options.left_share - 0.02, false));
  EXPECT_FALSE(due_with(4, options.left_share - 0.02, true));
}

TEST_F(KeyframeDue, AKeyframeIsDueWhereNearFeaturesWaitForALandmark) {
  options.keyframe_share = options.urgent_share = options.left_share = 0.0;  // another test's
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const auto due = [&](int index, int tracked, int fresh, bool adjusting = false) {
    Frame frame = frame_at({}, index);
    keep_static(frame, tracked + fresh);
    forget_points(frame, fresh);
    // What nothing static is seen of would be found in the map again, as trusted.
    for (const int l : map.landmarks()) map.landmark(l).dynamic_log_odds = 0.0F;
    const bool result = tracker().track(frame, adjusting).keyframe_due;
    EXPECT_EQ(tracker().tracked_landmarks(), tracked);
    tracker().settle(frame, false);
    return result;
  };
  EXPECT_TRUE(due(1, 90, 80));    // few tracked and many to gain
  EXPECT_FALSE(due(2, 110, 80));  // enough tracked
  EXPECT_FALSE(due(3, 90, 65));   // little to gain
  // While the last one is adjusted: not in the next frames, and not from a pose that may be poor.
  EXPECT_FALSE(due(2, 90, 80, true));
  EXPECT_TRUE(due(4, 90, 80, true));
  EXPECT_FALSE(due(5, options.least_for_motion - 2, 200, true));
}

TEST_F(KeyframeDue, NoKeyframeIsDueWhileSomebodyFillsTheView) {
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  for (const int few : {options.least_keyframe_features - 1, options.least_keyframe_features}) {
    // Long after the interval.
    Frame frame = frame_at({}, 100 + few);
    keep_static(frame, few);
    const TrackingResult result = track(frame);
    ASSERT_TRUE(result.localised);
    EXPECT_EQ(result.keyframe_due, few == options.least_keyframe_features);
  }
}

}  // namespace
}  // namespace dkp_slam

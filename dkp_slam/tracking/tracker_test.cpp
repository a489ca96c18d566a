#include "dkp_slam/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/tracking/test_tracking.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;
using testing::Tracking;

void expect_each_landmark_once(const Map& map, const Frame& frame) {
  std::set<int> seen;
  for (const int id : frame.landmark) {
    if (id < 0) continue;
    EXPECT_TRUE(map.has_landmark(id));
    EXPECT_TRUE(seen.insert(id).second) << "landmark " << id << " belongs to two features";
  }
}

TEST_F(Tracking, FollowsAMovingCamera) {
  for (int i = 0; i < 10; ++i) {
    const Se3 truth = pose(0.01 * i, 0.0, 0.0, 0.004 * i);
    Frame frame = frame_at(truth, i);
    ASSERT_TRUE(track(frame).localised);
    EXPECT_LT(pose_distance(frame.camera_from_world, truth), 1e-3);
    EXPECT_GT(tracker().tracked_landmarks(), 100);
  }
}

// The first feature's evidence removes the landmark, and the second one's was read from it.
TEST_F(Tracking, ALandmarkThatEvidenceRemovesIsReadByNobodyAfter) {
  // Two points whose pixels are just under the bound of an inlier apart.
  const MeasurementModel model;
  const double bound = std::sqrt(model.pixel_chi2) * model.pixel_sigma;
  world.points[1] = world.points[0];
  world.points[1].x() += 1.02 * bound * world.points[0].z() / world.camera.fx;
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const int a = feature_of(0), b = feature_of(1);
  ASSERT_GE(a, 0);
  ASSERT_GE(b, 0);
  const int kept = first.landmark[static_cast<std::size_t>(b)];
  // Only a few landmarks are followed from frame to frame, so that the odd one out pulls the pose
  // its way; the local map then puts it right, and the odd match is found out.
  Frame second = frame_at({}, 1);
  for (int f = 0; f < second.features.size(); ++f) {
    if (f != a && f != b && f % 14 != 0) second.is_static[static_cast<std::size_t>(f)] = 0;
  }
  ASSERT_TRUE(track(second).localised);
  map.fuse_landmarks(second.landmark[static_cast<std::size_t>(a)], kept);
  map.landmark(kept).dynamic_log_odds = TrackerOptions().belief.dynamic_above;
  Frame third = frame_at({}, 2);
  EXPECT_TRUE(track(third).localised);
  expect_each_landmark_once(map, third);
}

TEST_F(Tracking, IsCarriedByItsMotionAsLongAsSomebodyWalksPast) {
  follow(0, 5);
  const int longest = static_cast<int>(options.longest_carry * 30.0);
  for (int i = 5; i < 5 + longest; ++i) {
    Frame frame = covered(i);
    const TrackingResult result = track(frame);
    ASSERT_TRUE(result.localised) << i;
    EXPECT_FALSE(result.keyframe_due);
    EXPECT_EQ(tracker().tracked_landmarks(), 0);
    EXPECT_LT(pose_distance(frame.camera_from_world, steady(i)), 0.01);
  }
  // Now drift would pass for localisation.
  Frame late = covered(5 + longest);
  EXPECT_FALSE(track(late).localised);
  EXPECT_EQ(tracker().state(), TrackingState::lost);
}

TEST_F(Tracking, FindsTheMapAgainWhereItWasCarriedTo) {
  follow(0, 5);
  // Behind somebody the camera is jerked aside: where it was going nothing is to be found.
  const auto jerked = [](int i) { return i < 5 ? steady(i) : pose(0.04 + 0.025 * (i - 4), 0, 0); };
  for (int i = 5; i < 9; ++i) {
    Frame frame = covered(i);
    frame.current_from_previous = jerked(i) * jerked(i - 1).inverse();
    ASSERT_TRUE(track(frame).localised) << i;
  }
  // So few landmarks that no keyframe would be recognised by them, all in boxes, trusted.
  Frame frame = frame_at(jerked(9), 9);
  forget_points(frame, frame.features.size() - 25);
  std::fill(frame.is_static.begin(), frame.is_static.end(), 0);
  frame.current_from_previous = jerked(9) * jerked(8).inverse();
  ASSERT_TRUE(track(frame).localised);
  EXPECT_GE(tracker().tracked_landmarks(), 20);
  EXPECT_LT(pose_distance(frame.camera_from_world, jerked(9)), 0.002);
}

TEST_F(Tracking, FindsItselfNearWhereItWasLost) {
  fill_index = false;
  follow(0, 5);
  // Nothing tells where the camera went while the view was covered, but for the last frame.
  Frame covered_view = covered(5);
  covered_view.current_from_previous.reset();
  ASSERT_FALSE(track(covered_view).localised);
  // Ten pixels and more from there, where no frame is looked for that is tracked.
  const Se3 truth = pose(0.04, 0.03, 0.0, 0.02);
  for (const bool in_time : {false, true}) {
    Frame frame = frame_at(truth, in_time ? 8 : 5 + static_cast<int>(31 * options.longest_carry));
    keep_static(frame, 60);
    ASSERT_EQ(track(frame).localised, in_time);
    if (in_time) {
      EXPECT_LT(pose_distance(frame.camera_from_world, truth), 2e-3);
    }
  }
}

TEST_F(Tracking, FindsItselfBehindAMaskThatIsWrong) {
  fill_index = false;
  follow(0, 5);
  // No landmark is trusted yet, and nothing tells how the camera moved.
  for (const int l : map.landmarks()) map.landmark(l).dynamic_log_odds = 0.0F;
  for (const int seen : {25, 200}) {
    Frame frame = frame_at(steady(5), 5);
    forget_points(frame, frame.features.size() - seen);
    std::fill(frame.is_static.begin(), frame.is_static.end(), 0);
    const bool found = track(frame).localised;
    EXPECT_EQ(found, seen == 200);  // so many do not agree by chance
    const auto back = std::count(frame.is_static.begin(), frame.is_static.end(), 1);
    EXPECT_NEAR(static_cast<double>(back), found ? seen : 0, 0.1 * seen);
    if (found) {
      EXPECT_LT(pose_distance(frame.camera_from_world, steady(5)), 2e-3);
    }
  }
}

TEST_F(Tracking, IsSoughtWhereItsLastMotionLeadsAfterAGap) {
  fill_index = false;
  // Points that look like each other: only where they lie tells them apart.
  for (std::size_t p = 0; p < world.descriptors.size(); ++p) {
    world.descriptors[p] = world.descriptors[p - p % 20];
  }
  const auto fast = [](int i) { return pose(0.1 * i, 0.0, 0.0); };
  for (int i = 0; i < 5; ++i) {
    Frame frame = frame_at(fast(i), i);
    ASSERT_TRUE(track(frame).localised) << i;
  }
  Frame frame = frame_at(fast(11), 11);
  ASSERT_TRUE(track(frame).localised);
  EXPECT_GE(tracker().tracked_landmarks(), options.least_for_motion);
  EXPECT_LT(pose_distance(frame.camera_from_world, fast(11)), 2e-3);
}

TEST_F(Tracking, IsPlacedByFewLandmarksAfterAGapWhereNothingElseTells) {
  fill_index = false;
  options.least_for_motion = 300;  // all are few
  follow(0, 5);
  Frame frame = frame_at(steady(11), 11);
  ASSERT_TRUE(track(frame).localised);
  EXPECT_GE(tracker().tracked_landmarks(), options.least_inliers);
  EXPECT_EQ(tracker().tracked_landmarks(), frame.tracked_landmarks());
  EXPECT_LT(pose_distance(frame.camera_from_world, steady(11)), 2e-3);
}

TEST_F(Tracking, IsCarriedByAMeasuredMotionOnly) {
  follow(0, 5);
  Frame frame = covered(5);
  frame.current_from_previous.reset();
  EXPECT_FALSE(track(frame).localised);
}

TEST_F(Tracking, IsNotCarriedOverAMissingFrame) {
  follow(0, 5);
  Frame frame = covered(6);  // its motion is since frame 5, which never came
  EXPECT_FALSE(track(frame).localised);
}

TEST_F(Tracking, DoesNotBelieveAMeasuredMotionThatNoCameraMakes) {
  follow(0, 5);
  Frame frame = covered(5);
  // Somebody's coat, half a metre in a thirtieth of a second.
  frame.current_from_previous = pose(0.5, 0.0, 0.0);
  ASSERT_TRUE(track(frame).localised);
  EXPECT_LT(pose_distance(frame.camera_from_world, steady(5)), 0.002);
}

TEST_F(Tracking, IsNotTakenAlongByWhoFillsTheViewAndWasMappedForTheRoom) {
  follow(0, 5);
  // Forty points go with somebody who turns, no faster than a camera can; that is the motion that
  // was measured. Eighty of the room are to be seen beside them.
  const Se3 taken_along = pose(0.0, 0.0, 0.0, 0.05) * steady(5);
  constexpr std::size_t theirs = 40;
  for (std::size_t i = 0; i < theirs; ++i) {
    world.points[i] = steady(5).inverse() * (taken_along * world.points[i]);
  }
  Frame frame = frame_at(steady(5), 5);
  keep_static(frame, theirs + 80);
  frame.current_from_previous = taken_along * steady(4).inverse();
  ASSERT_TRUE(track(frame).localised);
  EXPECT_LT(pose_distance(frame.camera_from_world, steady(5)), 0.005);
}

TEST_F(Tracking, ALandmarkThatMovesIsRemovedAfterTwoFramesAndNotAfterOne) {
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const int moved = first.landmark[static_cast<std::size_t>(feature_of(0))];
  world.points[0].x() += 4.0 * world.points[0].z() / world.camera.fx;  // by four pixels
  for (int i = 1; i <= 2; ++i) {
    ASSERT_TRUE(map.has_landmark(moved)) << i;
    Frame frame = frame_at({}, i);
    frame.is_static[static_cast<std::size_t>(feature_of(0))] = 0;
    ASSERT_TRUE(track(frame).localised);
    expect_each_landmark_once(map, frame);
  }
  EXPECT_FALSE(map.has_landmark(moved));
  EXPECT_EQ(map.live_landmarks(), 299);
}

TEST_F(Tracking, ALandmarkThatStaysIsTrustedThoughItsFeatureIsCalledDynamic) {
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const int id = first.landmark[static_cast<std::size_t>(feature_of(0))];
  // Called dynamic while it is new: not used, and a little doubted in its favour.
  Frame second = frame_at({}, 1);
  second.is_static[static_cast<std::size_t>(feature_of(0))] = 0;
  ASSERT_TRUE(track(second).localised);
  EXPECT_EQ(second.landmark[static_cast<std::size_t>(feature_of(0))], -1);
  EXPECT_FLOAT_EQ(map.landmark(id).dynamic_log_odds, options.belief.doubted);
  // Two good frames, and it withstands the same verdict.
  for (int i = 2; i < 4; ++i) {
    Frame good = frame_at({}, i);
    ASSERT_TRUE(track(good).localised);
  }
  EXPECT_LT(map.landmark(id).dynamic_log_odds, options.belief.trusted_below);
  Frame last = frame_at({}, 4);
  last.is_static[static_cast<std::size_t>(feature_of(0))] = 0;
  ASSERT_TRUE(track(last).localised);
  EXPECT_EQ(last.landmark[static_cast<std::size_t>(feature_of(0))], id);
}

TEST_F(Tracking, ALandmarkUnderSuspicionIsRehabilitatedByStaying) {
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const int id = first.landmark[static_cast<std::size_t>(feature_of(0))];
  map.landmark(id).dynamic_log_odds = options.belief.dynamic_above;  // one more doubt, and it goes
  float before = map.landmark(id).dynamic_log_odds;
  for (int i = 1; i <= 20; ++i) {
    Frame frame = frame_at({}, i);
    ASSERT_TRUE(track(frame).localised);
    ASSERT_TRUE(map.has_landmark(id));
    EXPECT_LE(map.landmark(id).dynamic_log_odds, before);
    before = map.landmark(id).dynamic_log_odds;
  }
  // Of every other landmark as of this one: no past counts for ever.
  EXPECT_FLOAT_EQ(before, options.belief.lowest);
}

TEST_F(Tracking, WaitsWithItsStartUntilEnoughOfTheRoomIsSeen) {
  for (int i = 0; i < 10; ++i) {
    Frame frame = frame_at(steady(i), i);
    keep_static(frame, options.least_to_start - 1);  // the rest is on a person
    const TrackingResult result = track(frame);
    EXPECT_FALSE(result.localised);
    EXPECT_FALSE(result.keyframe_due);
    EXPECT_EQ(tracker().state(), TrackingState::not_initialized);
  }
  Frame frame = frame_at(steady(10), 10);
  keep_static(frame, options.least_to_start);
  EXPECT_TRUE(track(frame).keyframe_due);
  EXPECT_EQ(tracker().state(), TrackingState::tracking);
}

TEST_F(Tracking, NeedsFeaturesWithDepthForItsStart) {
  Frame frame = frame_at({}, 0);
  std::fill(frame.features.depth.begin(), frame.features.depth.end(), 0.0F);
  EXPECT_FALSE(track(frame).localised);
  EXPECT_EQ(map.keyframe_ids(), 0);
}

/// Follows `seen` frames, then loses the room for `lost`, and begins another map with the next one.
void expect_another_map_after(Tracking& tracking, int seen, int lost) {
  tracking.follow(0, seen);
  for (Descriptor& d : tracking.world.descriptors) d = tracking.world.random_descriptor();
  for (int i = seen; i < seen + lost; ++i) {
    Frame frame = tracking.frame_at({}, i);
    ASSERT_FALSE(tracking.track(frame).localised) << i;
  }
  EXPECT_EQ(tracking.map.maps(), 1);
  Frame frame = tracking.frame_at({}, seen + lost);
  const TrackingResult result = tracking.track(frame);
  EXPECT_TRUE(result.localised);
  EXPECT_TRUE(result.keyframe_due);
  EXPECT_EQ(tracking.map.maps(), 2);
  EXPECT_EQ(tracking.map.current_map(), 1);
  EXPECT_EQ(tracking.map.live_keyframes_in(1), 1);
  EXPECT_EQ(tracking.tracker().state(), TrackingState::tracking);
}

TEST_F(Tracking, BeginsAnotherMapWhenLostForTooLong) {
  const int longest = static_cast<int>(options.longest_loss * 30.0);
  expect_another_map_after(*this, 2 * longest, longest);
}

TEST_F(Tracking, WaitsForAMapTwiceAsLongAsItFollowedIt) { expect_another_map_after(*this, 5, 8); }

TEST_F(Tracking, BeginsAnotherMapWhereItsFirstStepIsFasterThanACameraIsCarried) {
  fill_index = false;
  // Who takes up the view moved, and the map's first keyframe is of nothing else.
  const auto maps_after_step = [&](int seen, double speed) {
    follow(0, seen);
    const Se3 truth = pose(0.01 * (seen - 1) + speed / 30.0, 0.0, 0.0);
    Frame frame = frame_at(truth, seen);
    EXPECT_TRUE(track(frame).localised);
    const int maps = map.maps();
    if (maps == 1) {
      EXPECT_LT(pose_distance(frame.camera_from_world, truth), 2e-3);
    }
    map = Map(world.camera, 1.2F, 8);
    made_.reset();
    return maps;
  };
  EXPECT_EQ(maps_after_step(1, 0.95 * options.most_first_speed), 1);
  EXPECT_EQ(maps_after_step(1, 1.05 * options.most_first_speed), 2);
  EXPECT_EQ(maps_after_step(2, 1.05 * options.most_first_speed), 1) << "the map has proved itself";
}

TEST_F(Tracking, GoesOnInAnotherMapWhereItWasCarriedOutOfTheFirst) {
  options.least_to_go_on = 250;
  const int longest = static_cast<int>(options.longest_carry * 30.0);
  for (const int seen : {240, 260}) {
    follow(0, 5);
    for (int i = 5; i <= 5 + longest; ++i) {
      Frame frame = covered(i);  // by what is no room, or by a room that it has never seen
      if (i == 5 + longest) keep_static(frame, seen);
      const TrackingResult result = track(frame);
      const bool last = i == 5 + longest;
      ASSERT_EQ(result.localised, !last || seen == 260) << i;
      EXPECT_EQ(result.keyframe_due, last && seen == 260);
      if (!result.localised) continue;
      EXPECT_LT(pose_distance(frame.camera_from_world, steady(i)), 0.01);
    }
    EXPECT_EQ(map.maps(), seen == 260 ? 2 : 1);
    made_.reset();
  }
}

TEST_F(Tracking, GoesOnInItsMapWhereItWasCarriedIntoWhatThatDoesNotKnow) {
  options.least_to_go_on = 250;
  options.longest_unmapped = 0.25;  // after frame 4, between frames 11 and 12
  for (const int seen : {240, 260}) {
    follow(0, 5);
    for (int i = 5; i < 16; ++i) {
      Frame frame = covered(i);
      keep_static(frame, seen);
      const TrackingResult result = track(frame);
      ASSERT_TRUE(result.localised) << i;
      EXPECT_EQ(result.keyframe_due, seen == 260 && i == 12) << i;
      // Each frame shows something else: but for its keyframe it is carried.
      EXPECT_EQ(tracker().tracked_landmarks() > 0, result.keyframe_due);
      EXPECT_LT(pose_distance(frame.camera_from_world, steady(i)), 0.01);
    }
    EXPECT_EQ(map.maps(), 1);
    made_.reset();
  }
}

TEST_F(Tracking, GoesOnInNoMapThatAFewLandmarksAloneLeadBackTo) {
  options.least_to_go_on = 250;
  const int few = options.least_for_motion - 10;
  for (const bool measured : {true, false}) {
    follow(0, 5);
    Frame doubtful = frame_at(steady(5), 5);
    forget_points(doubtful, doubtful.features.size() - few);
    if (measured) doubtful.current_from_previous = steady(5) * steady(4).inverse();
    ASSERT_TRUE(track(doubtful).localised);
    ASSERT_GT(tracker().tracked_landmarks(), 0);
    ASSERT_LT(tracker().tracked_landmarks(), options.least_for_motion);
    int keyframes = 0;
    for (int i = 6; i < 20; ++i) {
      Frame frame = covered(i);
      keep_static(frame, 260);
      const TrackingResult result = track(frame);
      ASSERT_TRUE(result.localised) << i;
      keyframes += result.keyframe_due;
    }
    EXPECT_EQ(keyframes, measured ? 1 : 0);
    EXPECT_EQ(map.maps(), 1);
    made_.reset();
  }
}

TEST_F(Tracking, FindsItsPlaceAgainWithinThatTimeAndBeginsNoMap) {
  follow(0, 20);
  for (int i = 20; i < 37; ++i) {
    Frame blind = frame_at(steady(i), i);
    forget_points(blind, blind.features.size());
    ASSERT_FALSE(track(blind).localised);
  }
  const Se3 truth = pose(0.05, 0.02, 0.0, 0.01);
  Frame seeing = frame_at(truth, 37);
  ASSERT_TRUE(track(seeing).localised);
  EXPECT_LT(pose_distance(seeing.camera_from_world, truth), 1e-3);
  EXPECT_EQ(map.maps(), 1);
}

TEST_F(Tracking, LocalizeOnlyLeavesTheMapAsItIs) {
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const MapParts before = parts_of(map);
  localize_only = true;
  made_.reset();
  // Lost at first, as in any map from before; then for so long that another map would be begun; and
  // with landmarks that move.
  for (int i = 0; i < 100; ++i) {
    Frame frame = frame_at(steady(i % 10), i);
    if (i > 20 && i < 80) forget_points(frame, frame.features.size());
    if (i > 80) frame.is_static[5] = 0;
    const TrackingResult result = track(frame);
    EXPECT_EQ(result.localised, i <= 20 || i >= 80) << i;
    EXPECT_FALSE(result.keyframe_due);
  }
  const MapParts after = parts_of(map);
  EXPECT_EQ(after.maps, before.maps);
  ASSERT_EQ(after.keyframes.size(), before.keyframes.size());
  ASSERT_EQ(after.landmarks.size(), before.landmarks.size());
  for (std::size_t l = 0; l < after.landmarks.size(); ++l) {
    EXPECT_EQ(after.landmarks[l].position, before.landmarks[l].position);
    EXPECT_EQ(after.landmarks[l].visible, before.landmarks[l].visible);
    EXPECT_EQ(after.landmarks[l].found, before.landmarks[l].found);
    EXPECT_EQ(after.landmarks[l].dynamic_log_odds, before.landmarks[l].dynamic_log_odds);
  }
}

}  // namespace
}  // namespace dkp_slam

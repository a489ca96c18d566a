#include "dkp_slam/system/back_end.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

struct KeyframesIn : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;

  /// A frame that shows the world and knows none of its landmarks.
  Frame tracked_at(const Se3& camera_from_world, int index) {
    std::vector<int> points;
    Frame frame = world.frame_at(camera_from_world, points);
    frame.index = index;
    frame.timestamp = index / 30.0;
    return frame;
  }
  /// Gives the frame the landmarks of a keyframe.
  void track(Frame& frame, int keyframe) const {
    const Keyframe& k = map.keyframe(keyframe);
    for (std::size_t f = 0; f < frame.landmark.size(); ++f) {
      const auto& all = k.features.descriptor;
      const auto same = std::find(all.begin(), all.end(), frame.features.descriptor[f]);
      if (same != all.end()) frame.landmark[f] = k.landmarks[std::size_t(same - all.begin())];
    }
  }
  /// Frames in which nothing happens but what is under way.
  static void pass(BackEnd& back_end, int from, int to) {
    for (int i = from; i < to; ++i) back_end.advance(i);
  }
};

TEST_F(KeyframesIn, AKeyframeThatClosesALoopIsPutRight) {
  BackEndOptions options;
  options.loops.detector.consistent = 1;
  BackEnd closing(map, places, MeasurementModel(), options);
  Frame before = tracked_at({}, 0);
  closing.insert_keyframe(before);
  // Back in the same place by a way that is lost: it knows no landmark and is 15 cm off.
  Frame after = tracked_at(pose(0.05, 0.0, 0.0), 1);
  const Se3 truth = after.camera_from_world;
  after.camera_from_world = pose(0.15, 0.0, 0.0) * truth;
  closing.insert_keyframe(after);
  EXPECT_TRUE(closing.loops().empty());
  pass(closing, 2, 40);
  ASSERT_EQ(closing.loops().size(), 1U);
  EXPECT_EQ(closing.loops()[0].old_keyframe, 0);
  EXPECT_NEAR(closing.loops()[0].moved, 0.15, 1e-4);
  EXPECT_LT(pose_distance(map.keyframe(1).camera_from_world, truth), 1e-4);
  EXPECT_GT(map.keyframe(1).covisible.at(0), 200);
  closing.finish(false);
}

TEST_F(KeyframesIn, MapsThatMeetBecomeOneAndNothingIsLost) {
  BackEndOptions options;
  options.loops.detector.consistent = 1;
  BackEnd joining(map, places, MeasurementModel(), options);
  Frame before = tracked_at({}, 0);
  joining.insert_keyframe(before);
  // Lost, another map is begun in a world of its own: there the same place lies elsewhere.
  map.start_map();
  Frame after = tracked_at(pose(0.05, 0.0, 0.0), 1);
  const Se3 truth = after.camera_from_world;
  after.camera_from_world = pose(0.4, -0.3, 0.2, 0.7);
  joining.insert_keyframe(after);
  pass(joining, 2, 40);
  ASSERT_EQ(joining.loops().size(), 1U);
  EXPECT_TRUE(joining.loops()[0].joined_maps);
  EXPECT_EQ(map.current_map(), 0);
  EXPECT_EQ(map.keyframes_in(0), (std::vector<int>{0, 1}));
  EXPECT_EQ(map.live_keyframes_in(1), 0);
  EXPECT_EQ(map.keyframe(1).parent, 0);
  EXPECT_EQ(map.keyframe(0).camera_from_world.translation.norm(), 0.0);  // the older map stays
  EXPECT_LT(pose_distance(map.keyframe(1).camera_from_world, truth), 1e-4);
  // What both saw is one now, and the rest of either is still there.
  EXPECT_GT(map.keyframe(1).covisible.at(0), 200);
  EXPECT_EQ(map.live_landmarks(), 300);
  for (int p = 0; p < map.landmark_ids(); ++p) {
    if (!map.has_landmark(p)) continue;
    const auto nearest = [&](const Eigen::Vector3d& point) {
      return (point - map.landmark(p).position).norm() < 1e-3;
    };
    EXPECT_TRUE(std::any_of(world.points.begin(), world.points.end(), nearest));
  }
  joining.finish(false);
}

TEST_F(KeyframesIn, MapsThatMeetWhileAnAdjustmentIsUnderWayBecomeOne) {
  BackEndOptions options;
  options.loops.detector.consistent = 1;
  options.mapper.bundle_delay = 1000;
  BackEnd joining(map, places, MeasurementModel(), options);
  // Two keyframes in each of two maps, the second one's in a world of its own.
  const Se3 there_from_here = pose(0.4, -0.3, 0.2, 0.7);
  std::vector<Se3> truth;
  for (int i = 0; i < 4; ++i) {
    if (i == 2) map.start_map();
    Frame frame = tracked_at(pose(0.05 * i, 0.0, 0.0), i);
    truth.push_back(frame.camera_from_world);
    if (i >= 2) frame.camera_from_world = truth.back() * there_from_here;
    if (i % 2 == 1) track(frame, i - 1);
    joining.insert_keyframe(frame);
  }
  ASSERT_TRUE(joining.adjusting());
  pass(joining, 4, 40);
  EXPECT_FALSE(joining.adjusting());
  ASSERT_EQ(joining.loops().size(), 1U);
  EXPECT_TRUE(joining.loops()[0].joined_maps);
  EXPECT_EQ(map.live_keyframes_in(0), 4);
  for (int k = 0; k < 4; ++k) {
    EXPECT_LT(pose_distance(map.keyframe(k).camera_from_world, truth[std::size_t(k)]), 1e-3);
  }
  joining.finish(false);
}

TEST_F(KeyframesIn, TheEndClosesALoopThatIsUnderWayUnlessItIsStopped) {
  for (const bool stopped : {true, false}) {
    Map fresh(world.camera, 1.2F, 8);
    PlaceIndex none;
    BackEndOptions options;
    options.loops.detector.consistent = 1;
    BackEnd closing(fresh, none, MeasurementModel(), options);
    Frame before = tracked_at({}, 0);
    closing.insert_keyframe(before);
    Frame after = tracked_at(pose(0.05, 0.0, 0.0), 1);
    after.camera_from_world = pose(0.15, 0.0, 0.0) * after.camera_from_world;
    closing.insert_keyframe(after);
    pass(closing, 2, 6);
    EXPECT_TRUE(closing.loops().empty());
    const std::atomic<bool> stop{stopped};
    closing.finish(true, &stop);
    EXPECT_EQ(closing.loops().size(), stopped ? 0U : 1U);
  }
}

}  // namespace
}  // namespace dkp_slam

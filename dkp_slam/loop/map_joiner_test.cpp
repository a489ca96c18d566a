#include "dkp_slam/loop/map_joiner.h"

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

/// Where the second map's world lies in the first one's.
const Se3 first_from_second = pose(1.5, -0.4, 0.7, 0.9);

struct MapJoiner : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;

  /// `count` keyframes of the current map that see the points of a world, from its own places, in a
  /// frame that lies at `world_from_map`.
  void add_keyframes(const PointWorld& seen, int count, const Se3& world_from_map) {
    std::map<int, int> landmark_of;
    for (int i = 0; i < count; ++i) {
      std::vector<int> points;
      Frame frame = seen.frame_at(pose(0.04 * i, 0.02 * i, 0.0), points);
      for (std::size_t f = 0; f < points.size(); ++f) {
        const auto known = landmark_of.find(points[f]);
        if (known != landmark_of.end()) frame.landmark[f] = known->second;
      }
      frame.camera_from_world = frame.camera_from_world * world_from_map;
      const std::vector<int> before = frame.landmark;
      const int id = seen.add_keyframe(map, frame, points);
      for (std::size_t f = 0; f < points.size(); ++f) {
        landmark_of[points[f]] = frame.landmark[f];
        Landmark& landmark = map.landmark(frame.landmark[f]);
        if (before[f] < 0) landmark.position = world_from_map.inverse() * landmark.position;
      }
      for (const int l : frame.landmark) map.refresh(l);
      places.add_keyframe(map, id);
    }
  }
};

TEST_F(MapJoiner, MapsOfOnePlaceBecomeOne) {
  add_keyframes(world, 4, Se3());
  map.start_map();
  add_keyframes(world, 5, first_from_second);
  const std::vector<JoinedMaps> joined = join_maps(map, places, MeasurementModel());
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].kept, 0);
  EXPECT_EQ(joined[0].moved, 1);
  EXPECT_EQ(joined[0].keyframes, 5);
  EXPECT_EQ(map.live_keyframes_in(0), 9);
  EXPECT_EQ(map.live_keyframes_in(1), 0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT(pose_distance(map.keyframe(4 + i).camera_from_world, pose(0.04 * i, 0.02 * i, 0.0)),
              1e-3);
  }
  EXPECT_EQ(map.live_landmarks(), 300);
  EXPECT_GT(map.keyframe(4).covisible.at(0), 200);
}

TEST_F(MapJoiner, MapsOfDifferentPlacesStayApart) {
  add_keyframes(world, 4, Se3());
  map.start_map();
  PointWorld elsewhere(300);
  for (Descriptor& d : elsewhere.descriptors) d = world.random_descriptor();
  add_keyframes(elsewhere, 5, first_from_second);
  EXPECT_TRUE(join_maps(map, places, MeasurementModel()).empty());
  EXPECT_EQ(map.live_keyframes_in(1), 5);
}

TEST_F(MapJoiner, TooFewThatAgreeJoinNothing) {
  add_keyframes(world, 4, Se3());
  map.start_map();
  add_keyframes(world, 2, first_from_second);
  EXPECT_TRUE(join_maps(map, places, MeasurementModel()).empty());
}

TEST_F(MapJoiner, KeyframesThatContradictOneAnotherJoinNothing) {
  // Each of them sees the place, but the map has them metres apart: none of it can be believed.
  add_keyframes(world, 4, Se3());
  map.start_map();
  for (int i = 0; i < 4; ++i) add_keyframes(world, 1, pose(3.0 * i, 0.0, 0.0, 0.8 * i));
  EXPECT_TRUE(join_maps(map, places, MeasurementModel()).empty());
  EXPECT_EQ(map.live_keyframes_in(1), 4);
}

TEST_F(MapJoiner, ThreeMapsInARowBecomeOne) {
  add_keyframes(world, 4, Se3());
  for (const double x : {1.0, -2.0}) {
    map.start_map();
    add_keyframes(world, 4, pose(x, 0.3, 0.1, 0.4));
  }
  EXPECT_EQ(join_maps(map, places, MeasurementModel()).size(), 2U);
  EXPECT_EQ(map.live_keyframes_in(0), 12);
}

}  // namespace
}  // namespace dkp_slam

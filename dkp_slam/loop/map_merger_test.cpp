#include "dkp_slam/loop/map_merger.h"

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/map/map_snapshot.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

/// A map of `count` keyframes whose world lies at `world_from_map`.
Map map_of(const PointWorld& world, int count, const Se3& world_from_map) {
  Map map(world.camera, 1.2F, 8);
  std::map<int, int> landmark_of;
  for (int i = 0; i < count; ++i) {
    std::vector<int> points;
    Frame frame = world.frame_at(pose(0.04 * i, 0.02 * i, 0.0), points);
    for (std::size_t f = 0; f < points.size(); ++f) {
      const auto known = landmark_of.find(points[f]);
      if (known != landmark_of.end()) frame.landmark[f] = known->second;
    }
    frame.camera_from_world = frame.camera_from_world * world_from_map;
    const std::vector<int> before = frame.landmark;
    world.add_keyframe(map, frame, points);
    for (std::size_t f = 0; f < points.size(); ++f) {
      landmark_of[points[f]] = frame.landmark[f];
      Landmark& landmark = map.landmark(frame.landmark[f]);
      if (before[f] < 0) landmark.position = world_from_map.inverse() * landmark.position;
    }
    for (const int l : frame.landmark) map.refresh(l);
  }
  return map;
}

TEST(MapMerger, MapsOfOnePlaceAreJoinedAndTheOriginalsStay) {
  const PointWorld world(300);
  const Map a = map_of(world, 4, Se3()), b = map_of(world, 5, pose(1.5, -0.4, 0.7, 0.9));
  const MergedMap both = merge_maps(parts_of(a), parts_of(b));
  ASSERT_EQ(both.joined.size(), 1U);
  EXPECT_EQ(both.map.live_keyframes_in(both.joined[0].kept), 9);
  EXPECT_LT(pose_distance(both.map.keyframe(6).camera_from_world, pose(0.08, 0.04, 0.0)), 2e-3);
  EXPECT_EQ(a.live_keyframes(), 4);
  EXPECT_EQ(b.live_keyframes(), 5);
}

TEST(MapMerger, MapsOfDifferentPlacesLieSideBySide) {
  PointWorld world(300);
  PointWorld elsewhere(300);
  for (Descriptor& d : elsewhere.descriptors) d = world.random_descriptor();
  const MergedMap both =
      merge_maps(parts_of(map_of(world, 4, Se3())), parts_of(map_of(elsewhere, 5, Se3())));
  EXPECT_TRUE(both.joined.empty());
  EXPECT_EQ(both.map.live_keyframes_in(0), 4);
  EXPECT_EQ(both.map.live_keyframes_in(1), 5);
}

}  // namespace
}  // namespace dkp_slam

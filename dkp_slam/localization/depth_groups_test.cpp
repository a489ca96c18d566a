#include "dkp_slam/localization/depth_groups.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose_distance;

TEST(SplitByDepth, BetweenTheNearOnesAndTheFarOnes) {
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 30; ++i) observations.push_back({{0.0, 0.0, i % 3 == 0 ? 0.8 : 3.0}, {}});
  const DepthGroups groups = split_by_depth({}, observations, 5);
  EXPECT_EQ(groups.near.size(), 10U);
  EXPECT_EQ(groups.far.size(), 20U);
  for (const std::size_t i : groups.near) EXPECT_EQ(i % 3, 0U);
  // Neither group is smaller than asked for, and what is too little for two is one.
  EXPECT_EQ(split_by_depth({}, observations, 15).near.size(), 15U);
  EXPECT_TRUE(split_by_depth({}, observations, 16).far.empty());
  EXPECT_EQ(split_by_depth({}, observations, 16).near.size(), 30U);
}

/// The map is of a room and of something before it; in the frame that has moved, the camera, too.
class MatchesOnRoom : public ::testing::Test {
 protected:
  /// `count` points about (x, y, z), evenly within so far of it to all sides.
  void add(int count, const Eigen::Vector3d& middle, const Eigen::Vector3d& reach) {
    std::uniform_real_distribution<double> side(-1.0, 1.0);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d way(side(world_.random), side(world_.random), side(world_.random));
      world_.points.push_back(middle + reach.cwiseProduct(way));
      world_.descriptors.push_back(world_.random_descriptor());
    }
  }
  void room(int count) { add(count, {0.0, 0.0, 3.5}, {1.6, 1.2, 1.0}); }
  void jacket(int count) { add(count, {0.0, 0.0, 0.8}, {0.12, 0.15, 0.04}); }
  /// The map as it was made, from the origin.
  void see() {
    std::vector<int> shown;
    Frame first = world_.frame_at({}, shown);
    world_.add_keyframe(map_, first, shown);
    landmark_of_.assign(world_.points.size(), -1);
    for (std::size_t f = 0; f < shown.size(); ++f) {
      landmark_of_[static_cast<std::size_t>(shown[f])] = first.landmark[f];
    }
  }
  /// Points from the first to before the last, each by `motion()`.
  template <typename Motion>
  void move(std::size_t first, std::size_t last, const Motion& motion) {
    for (std::size_t i = first; i < last; ++i) world_.points[i] += motion();
  }
  /// What `matches_on_room` gives, with the frame's pose as the tracker has it.
  std::vector<FrameMatch> on_room() {
    std::vector<int> shown;
    frame_ = world_.frame_at(truth_, shown);
    std::vector<FrameMatch> matches;
    for (std::size_t f = 0; f < shown.size(); ++f) {
      const int l = landmark_of_[static_cast<std::size_t>(shown[f])];
      if (l >= 0) matches.push_back({static_cast<int>(f), l, map_.landmark(l).position, 0});
    }
    std::vector<FrameMatch> tracked = matches;
    refine_pose(map_, model_, frame_, tracked);
    return matches_on_room(map_, model_, frame_, matches);
  }

  PointWorld world_{0};
  Map map_{world_.camera, 1.2F, 8};
  MeasurementModel model_;
  const Se3 truth_ = Se3::exp((Vector6d() << 0.02, -0.01, 0.01, 0.004, -0.006, 0.002).finished());
  std::vector<int> landmark_of_;
  Frame frame_;
};

TEST_F(MatchesOnRoom, WhereSomebodyWhoWasThereFromTheStartWalksAway) {
  jacket(200);
  room(120);
  see();
  move(0, 200, [] { return Eigen::Vector3d(0.06, 0.0, 0.01); });
  std::vector<FrameMatch> matches = on_room();
  EXPECT_GT(pose_distance(frame_.camera_from_world, truth_), 0.02) << "most is his";
  ASSERT_GE(matches.size(), 40U);
  for (const FrameMatch& m : matches) EXPECT_GT(m.position.z(), 2.0);
  refine_pose(map_, model_, frame_, matches);
  EXPECT_LT(pose_distance(frame_.camera_from_world, truth_), 1e-3);
}

TEST_F(MatchesOnRoom, WhereHeTurnsAsHeGoes) {
  jacket(200);
  room(120);
  see();
  std::uniform_real_distribution<double> way(-0.1, 0.1);
  move(0, 200, [&] { return Eigen::Vector3d(way(world_.random), way(world_.random), 0.0); });
  const std::vector<FrameMatch> matches = on_room();
  ASSERT_GE(matches.size(), 40U);
  for (const FrameMatch& m : matches) EXPECT_GT(m.position.z(), 2.0);
}

TEST_F(MatchesOnRoom, NoneAreAskedForWhereNothingMoves) {
  jacket(200);
  room(120);
  see();
  EXPECT_TRUE(on_room().empty());
  EXPECT_LT(pose_distance(frame_.camera_from_world, truth_), 1e-3);
}

TEST_F(MatchesOnRoom, SomebodyBehindADeskIsNoRoom) {
  add(200, {0.0, 0.2, 1.0}, {0.5, 0.3, 0.2});  // the desk
  add(120, {0.3, 0.0, 2.5}, {0.25, 0.5, 0.1});
  see();
  move(200, 320, [] { return Eigen::Vector3d(0.1, 0.0, 0.0); });
  EXPECT_TRUE(on_room().empty());
}

TEST_F(MatchesOnRoom, AFewLandmarksAreNoRoom) {
  jacket(200);
  room(30);
  see();
  move(0, 200, [] { return Eigen::Vector3d(0.06, 0.0, 0.01); });
  EXPECT_TRUE(on_room().empty());
  EXPECT_TRUE(matches_on_room(map_, model_, frame_, {}).empty());
}

TEST_F(MatchesOnRoom, ARoomThatFallsApartIsNone) {
  jacket(200);
  room(120);
  see();
  std::uniform_real_distribution<double> way(-0.3, 0.3);
  move(200, 320, [&] { return Eigen::Vector3d(way(world_.random), way(world_.random), 0.0); });
  EXPECT_TRUE(on_room().empty());
}

}  // namespace
}  // namespace dkp_slam

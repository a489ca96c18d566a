#include "dkp_slam/localization/depth_groups.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose_distance;

TEST(SplitByDepth, BetweenTheNearOnesAndTheFarOnes) {
  std::vector<PoseObservation> observations;
  const Observation anywhere{Eigen::Vector2d::Zero(), 0.0, 1.0};
  for (int i = 0; i < 30; ++i) observations.push_back({{0, 0, i % 3 == 0 ? 0.8 : 3.0}, anywhere});
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
  void jacket_before_room(int room_points = 120) {
    jacket(his);
    room(room_points);
    see();
  }
  /// Points from the first to before the last go the same way.
  void move(std::size_t first, std::size_t last, const Eigen::Vector3d& way) {
    for (std::size_t i = first; i < last; ++i) world_.points[i] += way;
  }
  void walk_away() { move(0, his, {0.06, 0.0, 0.01}); }
  /// Each goes its own way, this far to the sides at most.
  void scatter(std::size_t first, std::size_t last, double reach) {
    std::uniform_real_distribution<double> way(-reach, reach);
    for (std::size_t i = first; i < last; ++i) {
      world_.points[i] += Eigen::Vector3d(way(world_.random), way(world_.random), 0.0);
    }
  }
  static void expect_room_alone(const std::vector<FrameMatch>& matches) {
    ASSERT_GE(matches.size(), 40U);
    for (const FrameMatch& m : matches) EXPECT_GT(m.position.z(), 2.0);
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

  static constexpr int his = 200;
  PointWorld world_{0};
  Map map_{world_.camera, 1.2F, 8};
  MeasurementModel model_;
  const Se3 truth_ = Se3::exp((Vector6d() << 0.02, -0.01, 0.01, 0.004, -0.006, 0.002).finished());
  std::vector<int> landmark_of_;
  Frame frame_;
};

TEST_F(MatchesOnRoom, WhereSomebodyWhoWasThereFromTheStartWalksAway) {
  jacket_before_room();
  walk_away();
  std::vector<FrameMatch> matches = on_room();
  EXPECT_GT(pose_distance(frame_.camera_from_world, truth_), 0.02) << "most is his";
  expect_room_alone(matches);
  refine_pose(map_, model_, frame_, matches);
  EXPECT_LT(pose_distance(frame_.camera_from_world, truth_), 1e-3);
}

TEST_F(MatchesOnRoom, WhereHeTurnsAsHeGoes) {
  jacket_before_room();
  scatter(0, his, 0.1);
  expect_room_alone(on_room());
}

TEST_F(MatchesOnRoom, NoneAreAskedForWhereNothingMoves) {
  jacket_before_room();
  EXPECT_TRUE(on_room().empty());
  EXPECT_LT(pose_distance(frame_.camera_from_world, truth_), 1e-3);
}

TEST_F(MatchesOnRoom, SomebodyBehindADeskIsNoRoom) {
  add(200, {0.0, 0.2, 1.0}, {0.5, 0.3, 0.2});  // the desk
  add(120, {0.3, 0.0, 2.5}, {0.25, 0.5, 0.1});
  see();
  move(200, 320, {0.1, 0.0, 0.0});
  EXPECT_TRUE(on_room().empty());
}

TEST_F(MatchesOnRoom, AFewLandmarksAreNoRoom) {
  jacket_before_room(30);
  walk_away();
  EXPECT_TRUE(on_room().empty());
  EXPECT_TRUE(matches_on_room(map_, model_, frame_, {}).empty());
}

TEST_F(MatchesOnRoom, ARoomThatFallsApartIsNone) {
  jacket_before_room();
  scatter(his, his + 120, 0.3);
  EXPECT_TRUE(on_room().empty());
}

}  // namespace
}  // namespace dkp_slam

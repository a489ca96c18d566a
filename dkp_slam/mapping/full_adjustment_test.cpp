#include "dkp_slam/mapping/full_adjustment.h"

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/mapping/local_bundle.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

/// A row of keyframes that see the same points without error, and whose poses (but the first's) the
/// map has wrong by up to 3 cm.
struct FullAdjustmentTest : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  FullAdjustment adjustment{world.camera, MeasurementModel(), FullAdjustmentOptions()};
  std::vector<Se3> truth;
  std::map<int, int> landmark_of;

  FullAdjustmentTest() {
    for (int k = 0; k < 6; ++k) add_keyframe(k == 0 ? Se3() : pose(0.01, -0.02, 0.01, 0.005));
  }

  /// One step further, and wrong by that much.
  int add_keyframe(const Se3& error) {
    truth.push_back(pose(0.05 * double(truth.size()), 0.0, 0.0));
    std::vector<int> points;
    Frame frame = world.frame_at(truth.back(), points);
    for (std::size_t f = 0; f < points.size(); ++f) {
      const auto known = landmark_of.find(points[f]);
      if (known != landmark_of.end()) frame.landmark[f] = known->second;
    }
    frame.camera_from_world = error * truth.back();
    const int id = world.add_keyframe(map, frame, points);
    for (std::size_t f = 0; f < points.size(); ++f) landmark_of[points[f]] = frame.landmark[f];
    return id;
  }
  /// Frames pass; whether a result came due at one of them, and was carried back.
  bool carried_back(int from, int to) {
    for (int frame = from; frame < to; ++frame) {
      adjustment.advance(map, frame);
      if (!adjustment.due(frame)) continue;
      adjustment.carry_back(map);
      return true;
    }
    return false;
  }
  double worst_error() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      worst = std::max(worst, pose_distance(map.keyframe(int(k)).camera_from_world, truth[k]));
    }
    return worst;
  }
};

TEST_F(FullAdjustmentTest, IsCarriedBackAtItsFrameAndNoSooner) {
  ASSERT_GT(worst_error(), 0.02);
  EXPECT_FALSE(adjustment.due(1000));
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(100, 100 + 30 + 6));
  EXPECT_TRUE(carried_back(100 + 30 + 6, 100 + 30 + 7));
  EXPECT_EQ(adjustment.done(), 1);
  EXPECT_FALSE(adjustment.due(1000));
  EXPECT_LT(worst_error(), 1e-4);
}

TEST_F(FullAdjustmentTest, WhatCameMeanwhileMovesAlong) {
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(0, 1));
  // Two more, each as wrong as its parent is: placed exactly relative to it.
  const int first = add_keyframe(pose(0.01, -0.02, 0.01, 0.005));
  const int second = add_keyframe(pose(0.01, -0.02, 0.01, 0.005));
  map.keyframe(first).parent = 5;
  map.keyframe(second).parent = first;
  for (const int k : {first, second}) {
    const Se3 from_parent = truth[std::size_t(k)] * truth[std::size_t(k - 1)].inverse();
    map.keyframe(k).camera_from_world = from_parent * map.keyframe(k - 1).camera_from_world;
  }
  const Eigen::Vector3d seen(0.1, 0.2, 2.0);  // by the last keyframe, of a point that nobody knew
  Landmark& landmark = map.landmark(map.keyframe(second).landmarks[3]);
  map.remove_landmark(landmark.id);
  const int late =
      map.add_landmark(map.keyframe(second).camera_from_world.inverse() * seen, second, 3);
  ASSERT_TRUE(carried_back(1, 100));
  EXPECT_LT(worst_error(), 1e-4);
  EXPECT_LT((map.keyframe(second).camera_from_world * map.landmark(late).position - seen).norm(),
            1e-9);
}

TEST_F(FullAdjustmentTest, ANewOneStopsTheOneUnderWay) {
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(0, 35));
  map.keyframe(3).camera_from_world = pose(0.02, 0.0, 0.0) * map.keyframe(3).camera_from_world;
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(35, 35 + 36));
  EXPECT_TRUE(carried_back(35 + 36, 35 + 37));
  EXPECT_EQ(adjustment.done(), 1);
  EXPECT_LT(worst_error(), 1e-4);
}

TEST_F(FullAdjustmentTest, StoppedItLeavesTheMapAlone) {
  const double before = worst_error();
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(0, 10));
  adjustment.stop();
  EXPECT_FALSE(carried_back(10, 1000));
  EXPECT_EQ(worst_error(), before);
  EXPECT_EQ(adjustment.done(), 0);
}

TEST_F(FullAdjustmentTest, OtherMapsStayAsTheyAre) {
  map.start_map();
  landmark_of.clear();
  const Se3 error = pose(0.01, -0.02, 0.01, 0.005);
  const int apart = add_keyframe(error);
  const Se3 before = map.keyframe(apart).camera_from_world;
  adjustment.start(map, 0);
  ASSERT_TRUE(carried_back(0, 100));
  EXPECT_EQ(map.keyframe(apart).camera_from_world.translation, before.translation);
  EXPECT_LT(pose_distance(map.keyframe(5).camera_from_world, truth[5]), 1e-4);
}

TEST_F(FullAdjustmentTest, GoneMeanwhileIsPassedOver) {
  adjustment.start(map, 0);
  EXPECT_FALSE(carried_back(0, 1));
  map.keyframe(4).parent = 3;
  map.remove_keyframe(4);
  const int removed = map.keyframe(2).landmarks[0];
  map.remove_landmark(removed);
  map.fuse_landmarks(map.keyframe(2).landmarks[1], map.keyframe(2).landmarks[2]);
  ASSERT_TRUE(carried_back(1, 100));
  EXPECT_FALSE(map.has_landmark(removed));
  EXPECT_TRUE(map.keyframe(4).removed);
  for (const int k : {0, 1, 2, 3, 5}) {
    EXPECT_LT(pose_distance(map.keyframe(k).camera_from_world, truth[std::size_t(k)]), 1e-4);
  }
}

TEST_F(FullAdjustmentTest, TakenInPiecesTheSnapshotIsTheSame) {
  const BundleProblem at_once = full_bundle(map, MeasurementModel(), 0);
  FullBundle bundle(map, 3);
  int pieces = 1;
  while (!bundle.gather(map, MeasurementModel(), 1)) ++pieces;
  const BundleProblem in_pieces = std::move(bundle).take();
  EXPECT_EQ(pieces, 7);
  ASSERT_EQ(in_pieces.poses.size(), 6U);
  EXPECT_EQ(in_pieces.poses.back().keyframe, 0);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(in_pieces.poses[i].keyframe, at_once.poses[i].keyframe);
    EXPECT_EQ(in_pieces.poses[i].fixed, i == 5);
  }
  ASSERT_EQ(in_pieces.points.size(), at_once.points.size());
  ASSERT_EQ(in_pieces.sightings.size(), at_once.sightings.size());
  for (std::size_t i = 0; i < at_once.points.size(); ++i) {
    EXPECT_EQ(in_pieces.points[i].landmark, at_once.points[i].landmark);
  }
  for (std::size_t i = 0; i < at_once.sightings.size(); ++i) {
    EXPECT_EQ(in_pieces.sightings[i].pose, at_once.sightings[i].pose);
    EXPECT_EQ(in_pieces.sightings[i].point, at_once.sightings[i].point);
    EXPECT_EQ(in_pieces.sightings[i].seen.pixel, at_once.sightings[i].seen.pixel);
  }
}

TEST_F(FullAdjustmentTest, OfAMapTooLargeThePartAboutTheLoopIsAdjusted) {
  // Two more places, each of which shares landmarks with the one before alone.
  for (int place = 1; place < 3; ++place) {
    const std::vector<int> shared = map.landmarks_of({map.keyframe_ids() - 1});
    landmark_of.clear();
    for (int i = 0; i < 20; ++i) landmark_of[i] = shared[shared.size() - 1 - std::size_t(i)];
    for (int i = 0; i < 3; ++i) add_keyframe(Se3());
  }
  const std::size_t most = 900;  // of more than 3,000
  FullBundle bundle(map, 0, most);
  EXPECT_TRUE(bundle.gather(map, MeasurementModel(), 1000000));
  EXPECT_TRUE(bundle.cut());
  EXPECT_LT(bundle.sightings(), most + 400);
  const BundleProblem problem = std::move(bundle).take();
  ASSERT_LT(problem.poses.size(), 6U);
  bool any_fixed = false;
  for (const auto& p : problem.poses) {
    EXPECT_LT(p.keyframe, 6);
    any_fixed |= p.fixed;
  }
  EXPECT_TRUE(any_fixed);
}

}  // namespace
}  // namespace dkp_slam

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
  adjustment.start(map, 0, 100);
  EXPECT_FALSE(adjustment.due(100 + 30 + 5));
  ASSERT_TRUE(adjustment.due(100 + 30 + 6));
  adjustment.carry_back(map);
  EXPECT_EQ(adjustment.done(), 1);
  EXPECT_FALSE(adjustment.due(1000));
  EXPECT_LT(worst_error(), 1e-4);
}

TEST_F(FullAdjustmentTest, WhatCameMeanwhileMovesAlong) {
  adjustment.start(map, 0, 0);
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
  adjustment.carry_back(map);
  EXPECT_LT(worst_error(), 1e-4);
  EXPECT_LT((map.keyframe(second).camera_from_world * map.landmark(late).position - seen).norm(),
            1e-9);
}

TEST_F(FullAdjustmentTest, ANewOneStopsTheOneUnderWay) {
  adjustment.start(map, 0, 0);
  map.keyframe(3).camera_from_world = pose(0.02, 0.0, 0.0) * map.keyframe(3).camera_from_world;
  adjustment.start(map, 0, 50);
  EXPECT_FALSE(adjustment.due(50));
  adjustment.carry_back(map);
  EXPECT_EQ(adjustment.done(), 1);
  EXPECT_LT(worst_error(), 1e-4);
}

TEST_F(FullAdjustmentTest, StoppedItLeavesTheMapAlone) {
  const double before = worst_error();
  adjustment.start(map, 0, 0);
  adjustment.stop();
  EXPECT_FALSE(adjustment.due(1000));
  EXPECT_EQ(worst_error(), before);
  EXPECT_EQ(adjustment.done(), 0);
}

TEST_F(FullAdjustmentTest, OtherMapsStayAsTheyAre) {
  map.start_map();
  landmark_of.clear();
  const Se3 error = pose(0.01, -0.02, 0.01, 0.005);
  const int apart = add_keyframe(error);
  const Se3 before = map.keyframe(apart).camera_from_world;
  adjustment.start(map, 0, 0);
  adjustment.carry_back(map);
  EXPECT_EQ(map.keyframe(apart).camera_from_world.translation, before.translation);
  EXPECT_LT(pose_distance(map.keyframe(5).camera_from_world, truth[5]), 1e-4);
}

TEST_F(FullAdjustmentTest, AMapTooLargeIsLeftToThePoseGraph) {
  FullAdjustmentOptions options;
  options.most_sightings = 1000;
  FullAdjustment small(world.camera, MeasurementModel(), options);
  small.start(map, 0, 0);
  EXPECT_FALSE(small.due(1000));
}

}  // namespace
}  // namespace dkp_slam

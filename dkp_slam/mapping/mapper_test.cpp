#include "dkp_slam/mapping/mapper.h"

#include <atomic>
#include <set>

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/mapping/landmark_fusion.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

struct Mapping : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;
  Mapper mapper{map, places, MeasurementModel(), MapperOptions()};
  std::vector<int> points;

  /// A frame that has been tracked: it knows the landmarks of its points.
  Frame tracked_at(const Se3& camera_from_world, int index) {
    Frame frame = world.frame_at(camera_from_world, points);
    frame.index = index;
    frame.timestamp = index / 30.0;
    for (std::size_t f = 0; f < points.size(); ++f) {
      const auto known = landmark_of_.find(points[f]);
      if (known != landmark_of_.end()) frame.landmark[f] = map.resolve(known->second);
    }
    return frame;
  }
  int insert(Frame& frame) {
    mapper.adjust_around(mapper.insert_keyframe(frame), frame.index);
    for (std::size_t f = 0; f < points.size(); ++f) {
      if (frame.landmark[f] >= 0) landmark_of_[points[f]] = frame.landmark[f];
    }
    return frame.reference_keyframe;
  }
  void insert_two() {
    for (int k = 0; k < 2; ++k) {
      Frame frame = tracked_at(pose(0.1 * k, 0.0, 0.0), k);
      insert(frame);
    }
    mapper.finish(false);
  }
  std::map<int, int> landmark_of_;
};

TEST_F(Mapping, TheFirstKeyframeMakesALandmarkOfEveryStaticFeatureWithDepth) {
  Frame frame = tracked_at(pose(0.1, 0.2, 0.3, 0.1), 0);
  for (std::size_t f = 0; f < 30; ++f) frame.is_static[f] = 0;
  for (std::size_t f = 30; f < 50; ++f) frame.features.depth[f] = 0.0F;
  insert(frame);
  EXPECT_EQ(map.live_keyframes(), 1);
  EXPECT_EQ(map.live_landmarks(), frame.features.size() - 50);
  EXPECT_EQ(map.keyframe(0).features.size(), frame.features.size() - 30);
  for (std::size_t f = 0; f < points.size(); ++f) {
    if (f < 50) {
      EXPECT_EQ(frame.landmark[f], -1);
      continue;
    }
    const Landmark& l = map.landmark(frame.landmark[f]);
    EXPECT_LT((l.position - world.points[std::size_t(points[f])]).norm(), 1e-5);
    EXPECT_EQ(l.sightings.size(), 1U);
  }
}

TEST_F(Mapping, TrackedLandmarksGetASightingAndNewPlacesALandmark) {
  Frame first = tracked_at(pose(0.0, 0.0, 0.0, 0.2), 0);
  insert(first);
  const int before = map.live_landmarks();
  Frame second = tracked_at({}, 1);  // turned: new points come into view
  const int known = second.tracked_landmarks();
  ASSERT_GT(known, 100);
  ASSERT_LT(known, second.features.size());
  insert(second);
  EXPECT_EQ(map.live_landmarks(), before + second.features.size() - known);
  EXPECT_EQ(map.keyframe(1).covisible.at(0), known);
  EXPECT_EQ(map.keyframe(1).parent, 0);
}

TEST_F(Mapping, AKeyframeThatSharesNothingIsLinkedToTheOneItWasCarriedFrom) {
  insert_two();
  Frame carried = world.frame_at(pose(0.2, 0.0, 0.0), points);
  carried.reference_keyframe = 1;
  EXPECT_TRUE(map.keyframe(insert(carried)).covisible.empty());
  EXPECT_EQ(map.keyframe(2).parent, 1);
  // Another map has nothing to do with it.
  map.start_map();
  Frame elsewhere = world.frame_at({}, points);
  elsewhere.reference_keyframe = 2;
  EXPECT_EQ(map.keyframe(insert(elsewhere)).parent, -1);
}

TEST_F(Mapping, LandmarksMadeTwiceAreFused) {
  Frame first = tracked_at({}, 0);
  world.add_keyframe(map, first, points);
  const std::set<int> of_first(points.begin(), points.end());
  Frame second = tracked_at(pose(0.05, 0.0, 0.0), 1);
  // Enough known ones to be neighbours; all others are made again.
  for (std::size_t f = 0; f < 40; ++f) {
    if (of_first.count(points[f])) second.landmark[f] = map.keyframe(0).landmarks[f];
  }
  std::set<int> distinct = of_first;
  distinct.insert(points.begin(), points.end());
  world.add_keyframe(map, second, points);
  ASSERT_GT(map.live_landmarks(), int(distinct.size()) + 100);
  fuse_with_neighbours(map, MeasurementModel(), 1);
  EXPECT_EQ(map.live_landmarks(), int(distinct.size()));
}

TEST_F(Mapping, AdjustmentComesBackAtItsFrameAndCorrectsThePose) {
  Frame first = tracked_at({}, 0);
  insert(first);
  const Se3 truth = pose(0.1, 0.0, 0.05, 0.05);
  Frame second = tracked_at(truth, 1);
  second.camera_from_world = pose(0.01, 0.01, 0.0, 0.004) * truth;
  const Se3 wrong = second.camera_from_world;
  insert(second);
  EXPECT_TRUE(mapper.adjusting());
  for (int frame = 2; frame < 1 + MapperOptions().bundle_delay; ++frame) {
    mapper.advance(frame);
    EXPECT_EQ(pose_distance(map.keyframe(1).camera_from_world, wrong), 0.0);
  }
  mapper.advance(1 + MapperOptions().bundle_delay);
  EXPECT_FALSE(mapper.adjusting());
  EXPECT_LT(pose_distance(map.keyframe(1).camera_from_world, truth), 1e-4);
  EXPECT_EQ(pose_distance(map.keyframe(0).camera_from_world, Se3()), 0.0);  // holds the map
}

TEST_F(Mapping, FinishAdjustsTheWholeMap) {
  Frame first = tracked_at({}, 0);
  insert(first);
  std::vector<Se3> truth = {Se3()};
  for (int k = 1; k <= 3; ++k) {
    truth.push_back(pose(0.15 * k, 0.0, 0.0, 0.04 * k));
    Frame frame = tracked_at(truth.back(), 10 * k);
    insert(frame);
  }
  mapper.finish(false);
  for (int k = 1; k <= 3; ++k) {
    ASSERT_FALSE(map.keyframe(k).removed);
    map.keyframe(k).camera_from_world = pose(0.01, -0.01, 0.0) * truth[std::size_t(k)];
  }
  const Se3 before = map.keyframe(3).camera_from_world;
  const std::atomic<bool> stop{true};
  mapper.finish(true, &stop);
  EXPECT_EQ(pose_distance(map.keyframe(3).camera_from_world, before), 0.0);
  mapper.finish(true);
  for (int k = 0; k <= 3; ++k) {
    EXPECT_LT(pose_distance(map.keyframe(k).camera_from_world, truth[std::size_t(k)]), 1e-3);
  }
}

TEST_F(Mapping, LandmarksThatNoOtherKeyframeSeesGo) {
  Frame first = tracked_at({}, 0);
  insert(first);
  const int lonely = first.landmark[0];
  const int lonely_point = points[0];
  for (int k = 1; k <= 2; ++k) {
    Frame frame = tracked_at(pose(0.15 * k, 0.0, 0.0), 10 * k);
    for (std::size_t f = 0; f < points.size(); ++f) {
      if (points[f] == lonely_point) frame.is_static[f] = 0;
    }
    insert(frame);
  }
  EXPECT_FALSE(map.has_landmark(lonely));
  EXPECT_TRUE(map.has_landmark(first.landmark[150]));
}

TEST_F(Mapping, KeyframesThatAddNothingGoAndTheirPosesStayKnown) {
  std::vector<Se3> truth;
  for (int k = 0; k < 6; ++k) {
    truth.push_back(pose(0.002 * k, 0.0, 0.0));
    Frame frame = tracked_at(truth.back(), 10 * k);
    insert(frame);
  }
  mapper.finish(false);
  EXPECT_LE(map.live_keyframes(), 4);
  EXPECT_FALSE(map.keyframe(0).removed);
  EXPECT_FALSE(map.keyframe(5).removed);  // the newest
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT(pose_distance(map.keyframe_pose(k), truth[std::size_t(k)]), 1e-4);
  }
}

TEST_F(Mapping, FusionsAreForgottenWhenNobodyAsksAnyMore) {
  for (int k = 0; k < 40; ++k) {
    Frame frame = tracked_at(pose(0.1 * (k % 5), 0.0, 0.0), 10 * k);
    // Every fourth landmark is overlooked, made again, and fused with the one there was.
    for (std::size_t f = std::size_t(k) % 4; f < points.size(); f += 4) frame.landmark[f] = -1;
    insert(frame);
    const Frame next = tracked_at(pose(0.1 * (k % 5), 0.0, 0.0), 10 * k + 1);
    for (std::size_t f = 0; f < points.size(); ++f) {
      // What the frame has seen leads to a landmark, whatever became of it.
      if (map.keyframe(frame.reference_keyframe).landmarks[f] < 0) continue;
      ASSERT_TRUE(map.has_landmark(next.landmark[f]));
    }
  }
  int remembered = 0;
  for (int id = 0; id < map.landmark_ids(); ++id) {
    remembered += !map.has_landmark(id) && map.resolve(id) >= 0;
  }
  EXPECT_GT(map.fusions(), 1000);
  EXPECT_LT(remembered, 200);
}

TEST_F(Mapping, ASnapshotHoldsItsWindowAndFixesTheRest) {
  for (int k = 0; k < 4; ++k) {
    Frame frame = world.frame_at(pose(0.4 * k - 0.6, 0.0, 0.0), points);
    for (std::size_t f = 0; f < points.size() && k > 0; ++f) {
      const auto known = landmark_of_.find(points[f]);
      if (known != landmark_of_.end()) frame.landmark[f] = known->second;
    }
    world.add_keyframe(map, frame, points);
    for (std::size_t f = 0; f < points.size(); ++f) landmark_of_[points[f]] = frame.landmark[f];
  }
  LocalBundleOptions options;
  options.window = 2;
  const BundleProblem problem = local_bundle(map, MeasurementModel(), 3, options);
  std::set<int> moving, fixed;
  for (const auto& p : problem.poses) (p.fixed ? fixed : moving).insert(p.keyframe);
  EXPECT_EQ(moving, (std::set<int>{2, 3}));  // the newest and its nearest
  EXPECT_EQ(fixed, (std::set<int>{0, 1}));
  std::size_t sightings = 0;
  for (const auto& p : problem.points) sightings += map.landmark(p.landmark).sightings.size();
  EXPECT_EQ(problem.sightings.size(), sightings);
  const BundleProblem whole = full_bundle(map, MeasurementModel(), 0);
  EXPECT_EQ(whole.poses.size(), 4U);
  EXPECT_EQ(whole.points.size(), std::size_t(map.live_landmarks()));
}

TEST_F(Mapping, WhatWentMeanwhileIsPassedOver) {
  insert_two();
  const BundleProblem problem = full_bundle(map, MeasurementModel(), 0);
  BundleSolution solution{problem.poses, problem.points,
                          std::vector<char>(problem.sightings.size(), 0), true};
  for (auto& p : solution.points) p.position.z() += 1.0;
  solution.outlier[5] = 1;
  const int gone = problem.points[0].landmark, kept = problem.points[10].landmark;
  const int outlier = problem.points[std::size_t(problem.sightings[5].point)].landmark;
  const auto outlier_keyframe = problem.poses[std::size_t(problem.sightings[5].pose)].keyframe;
  const double z_kept = map.landmark(kept).position.z();
  map.remove_landmark(gone);
  map.remove_keyframe(1);
  solution.usable = false;  // stopped early: nothing is carried back
  apply_bundle(map, problem, solution);
  EXPECT_EQ(map.landmark(kept).position.z(), z_kept);
  solution.usable = true;
  apply_bundle(map, problem, solution);
  EXPECT_FALSE(map.has_landmark(gone));
  EXPECT_EQ(map.landmark(kept).position.z(), z_kept + 1.0);
  EXPECT_EQ(map.landmark(outlier).feature_in(outlier_keyframe), -1);
}

TEST_F(Mapping, TheWorkerSolvesWhatASingleThreadSolves) {
  insert_two();
  map.keyframe(1).camera_from_world.translation.x() += 0.01;
  const BundleProblem problem = full_bundle(map, MeasurementModel(), 0);
  const BundleSolution expected = adjust_bundle(world.camera, MeasurementModel(), problem);
  Worker<BundleProblem, BundleSolution> worker(
      "test", [&](const BundleProblem& asked, const std::atomic<bool>& stop) {
        return adjust_bundle(world.camera, MeasurementModel(), asked, {}, &stop);
      });
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(worker.pending());
    worker.submit(problem);
    EXPECT_TRUE(worker.pending());
    const BundleSolution solution = worker.take();
    ASSERT_TRUE(solution.usable);
    for (std::size_t p = 0; p < solution.poses.size(); ++p) {
      EXPECT_EQ(solution.poses[p].camera_from_world.translation,
                expected.poses[p].camera_from_world.translation);
    }
  }
  worker.submit(problem);  // and may be left with work under way
}

}  // namespace
}  // namespace dkp_slam

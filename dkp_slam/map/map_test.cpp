#include "dkp_slam/map/map.h"

#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

Camera plain_camera() {
  Camera camera;
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// A keyframe at (x, 0, 0) with `count` features, no landmarks yet.
Keyframe keyframe_at(double x, int count) {
  OrbFeatures orb;
  for (int i = 0; i < count; ++i) {
    orb.keypoints.emplace_back(float(10 + i), 100.0F, 31.0F, 0.0F, 1.0F, i % 3);
    orb.descriptors.push_back({static_cast<std::uint64_t>(i)});
  }
  Keyframe k;
  k.features = FrameFeatures(orb, cv::Mat(480, 640, CV_32F, cv::Scalar(2.0)), plain_camera());
  k.landmarks.assign(static_cast<std::size_t>(count), -1);
  k.camera_from_world.translation.x() = -x;
  return k;
}

/// Three keyframes; `shared` landmarks are seen by all, the third keyframe sees `extra` of its own.
struct MapOfThree : ::testing::Test {
  Map map{plain_camera(), 1.2F, 8};
  MapOfThree() {
    const int a = map.add_keyframe(keyframe_at(0.0, 60));
    for (int f = 0; f < 40; ++f) map.add_landmark({0.01 * f, 0.0, 2.0}, a, f);
    for (double x : {0.1, 0.2}) {
      Keyframe k = keyframe_at(x, 60);
      for (int f = 0; f < 40; ++f) k.landmarks[f] = f;
      map.update_covisibility(map.add_keyframe(std::move(k)));
    }
    for (int f = 40; f < 50; ++f) map.add_landmark({0.01 * f, 0.0, 2.0}, 2, f);
  }
};

TEST_F(MapOfThree, CovisibilityCountsSharedLandmarks) {
  EXPECT_EQ(map.keyframe(2).covisible, (std::map<int, int>{{0, 40}, {1, 40}}));
  EXPECT_EQ(map.keyframe(0).covisible.at(2), 40);
  EXPECT_EQ(map.keyframe(1).parent, 0);
}

TEST_F(MapOfThree, RemovingALandmarkFreesItsFeatures) {
  map.remove_landmark(5);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(map.keyframe(k).landmarks[5], -1);
  EXPECT_EQ(map.live_landmarks(), 49);
  EXPECT_EQ(map.resolve(5), -1);
}

TEST_F(MapOfThree, AMapBegunLaterIsApartUntilItIsMoved) {
  EXPECT_EQ(map.start_map(), 1);
  const int k = map.add_keyframe(keyframe_at(5.0, 60));
  const int l = map.add_landmark({5.0, 0.0, 2.0}, k, 7);
  map.update_covisibility(k);
  EXPECT_EQ(map.keyframe(k).map, 1);
  EXPECT_TRUE(map.keyframe(k).covisible.empty());
  EXPECT_EQ(map.keyframes_in(0), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(map.keyframes_in(1), std::vector<int>{k});

  // The second map's world lies 1 m to the left of the first one's.
  const Eigen::Vector3d seen = map.keyframe(k).camera_from_world * map.landmark(l).position;
  map.move_map(1, 0, Se3(Eigen::Quaterniond::Identity(), {-1.0, 0.0, 0.0}));
  EXPECT_EQ(map.current_map(), 0);
  EXPECT_TRUE(map.keyframes_in(1).empty());
  EXPECT_EQ(map.keyframe(k).map, 0);
  EXPECT_NEAR(map.landmark(l).position.x(), 4.0, 1e-12);
  EXPECT_NEAR(map.keyframe_pose(k).inverse().translation.x(), 4.0, 1e-12);
  const Eigen::Vector3d still = map.keyframe(k).camera_from_world * map.landmark(l).position;
  EXPECT_NEAR((still - seen).norm(), 0.0, 1e-12);
  EXPECT_NEAR(map.landmark(0).position.x(), 0.0, 1e-12);  // the first map stayed
}

TEST_F(MapOfThree, FusingMovesSightingsAndLeavesAForwardingAddress) {
  map.fuse_landmarks(45, 46);
  EXPECT_EQ(map.resolve(45), 46);
  EXPECT_EQ(map.landmark(46).sightings.size(), 1U);  // keyframe 2 sees 46 itself
  EXPECT_EQ(map.keyframe(2).landmarks[45], -1);
  map.remove_sighting(7, 2);
  map.fuse_landmarks(46, 7);
  EXPECT_EQ(map.landmark(7).feature_in(2), 46);
  EXPECT_EQ(map.resolve(45), 7);
}

TEST_F(MapOfThree, ARemovedKeyframeKeepsItsPlaceBesideItsParent) {
  map.remove_keyframe(1);
  EXPECT_EQ(map.live_keyframes(), 2);
  EXPECT_EQ(map.landmark(3).sightings.size(), 2U);
  map.keyframe(0).camera_from_world.translation.y() = 1.0;
  EXPECT_TRUE(map.keyframe_pose(1).translation.isApprox(Eigen::Vector3d(-0.1, 1.0, 0.0), 1e-12));
}

TEST_F(MapOfThree, LosingTheLastSightingRemovesTheLandmark) {
  map.remove_sighting(42, 2);
  EXPECT_FALSE(map.has_landmark(42));
}

TEST_F(MapOfThree, AForgottenFusionLeadsNowhere) {
  map.fuse_landmarks(45, 46);
  map.fuse_landmarks(47, 46);
  EXPECT_EQ(map.fusions(), 2);
  map.forget_fusions(1);
  EXPECT_EQ(map.resolve(45), -1);
  EXPECT_EQ(map.resolve(47), 46);
  map.forget_fusions(1);  // again: the same ones
  EXPECT_EQ(map.resolve(47), 46);
  map.forget_fusions(map.fusions());
  EXPECT_EQ(map.resolve(47), -1);
  EXPECT_EQ(map.resolve(46), 46);
  EXPECT_EQ(map.fusions(), 2);
}

TEST(LongRun, MemoryFollowsWhatIsInTheMapNotWhatHasBeen) {
  // 30 landmarks that are seen for ever, and with each keyframe 30 that go with it and 30 that turn
  // out to be the old ones. The last five keyframes stay.
  Map map{plain_camera(), 1.2F, 8};
  std::size_t early = 0;
  for (int step = 0; step < 600; ++step) {
    Keyframe k = keyframe_at(0.01 * step, 90);
    for (int f = 0; f < 30 && step > 0; ++f) k.landmarks[std::size_t(f)] = f;
    const int id = map.add_keyframe(std::move(k));
    std::vector<int> added;
    for (int f = step > 0 ? 30 : 0; f < 90; ++f)
      added.push_back(map.add_landmark({0.01 * f, 0.0, 2.0}, id, f));
    map.update_covisibility(id);
    for (std::size_t i = 0; i < 30 && step > 0; ++i) {
      map.fuse_landmarks(added[i], static_cast<int>(i));
      ASSERT_EQ(map.resolve(added[i]), static_cast<int>(i));
    }
    if (id > 5) map.remove_keyframe(id - 5);
    map.forget_fusions(map.fusions() - 60);
    if (step == 200) early = map.memory();
  }
  EXPECT_EQ(map.live_keyframes(), 6);
  EXPECT_EQ(map.live_landmarks(), 90 + 5 * 30);
  // A keyframe's place in the spanning tree is all that is left of each step.
  EXPECT_LT(map.memory() - early, 400 * (sizeof(Keyframe) + 40));
}

TEST_F(MapOfThree, PredictedLevelFollowsTheDistance) {
  const Landmark& l = map.landmark(0);  // seen on level 0 from 2 m
  EXPECT_EQ(map.predicted_level(l, 2.0), 0);
  EXPECT_EQ(map.predicted_level(l, 2.0 / (1.2 * 1.2) + 1e-4), 2);
  EXPECT_EQ(map.predicted_level(l, 0.01), 7);
}

TEST_F(MapOfThree, APredictedLevelIsOneOfThemAlsoWhereAStoredRangeIsNone) {
  Landmark l;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float range : {0.0F, -1.0F, infinity, std::nanf("")}) {
    l.max_distance = range;
    for (const double distance : {0.0, 2.0, std::numeric_limits<double>::infinity()}) {
      EXPECT_THAT(map.predicted_level(l, distance), AllOf(Ge(0), Le(map.levels() - 1)));
    }
  }
  l.max_distance = infinity;
  EXPECT_EQ(map.predicted_level(l, 2.0), map.levels() - 1);
}

/// World after a move from the world before it.
const Se3 moved(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())),
                {1.0, -2.0, 0.5});

TEST_F(MapOfThree, LandmarksMoveWithTheFirstKeyframeThatSeesThem) {
  const Map before = map;
  map.move({{{0, moved, {}}}, {}});
  for (int k = 0; k < 3; ++k) {
    const Se3 expected = k == 0 ? before.keyframe(k).camera_from_world * moved.inverse()
                                : before.keyframe(k).camera_from_world;
    EXPECT_EQ(map.keyframe(k).camera_from_world.translation, expected.translation);
  }
  for (int l = 0; l < 50; ++l) {
    const Landmark &was = before.landmark(l), &is = map.landmark(l);
    const bool moves = l < 40;  // the others the third keyframe alone sees
    EXPECT_LT((is.position - (moves ? moved * was.position : was.position)).norm(), 1e-12);
    EXPECT_LT((is.normal - (moves ? moved.rotation * was.normal : was.normal)).norm(), 1e-12);
    EXPECT_EQ(is.max_distance, was.max_distance);
  }
}

TEST_F(MapOfThree, ALandmarkWithAPlaceOfItsOwnGoesThereAndItsRangeFollows) {
  const Eigen::Vector3d place(0.1, 0.2, 4.0);
  const float before = map.landmark(3).max_distance;
  map.move({{{0, Se3(), {}}}, {{3, place}}});
  EXPECT_EQ(map.landmark(3).position, place);
  EXPECT_NEAR(map.landmark(3).max_distance / before, place.norm() / std::hypot(0.03, 2.0), 1e-5);
  EXPECT_EQ(map.landmark(4).position.z(), 2.0);
}

TEST_F(MapOfThree, WhenALandmarkFollowsMakesNoDifference) {
  Map asked_early = map, asked_late = map, in_turn = map;
  for (Map* each : {&asked_early, &asked_late, &in_turn}) {
    const auto look = [&] {
      for (int l = 0; l < 50 && each == &asked_early; ++l) each->landmark(l);
      if (each == &in_turn) each->follow_moves(7);
    };
    each->move({{{0, moved, {}}, {2, moved, {}}}, {}});
    look();
    // Adjusted on, and moved again, before most of them have been asked for.
    each->keyframe(0).camera_from_world.translation.y() += 0.01;
    each->move({{{0, moved.inverse(), {}}, {2, moved, {}}}, {{7, {0.0, 0.1, 3.0}}}});
    look();
    each->keyframe(2).parent = 0;
    each->remove_keyframe(2);
    each->add_landmark({5.0, 0.0, 5.0}, 0, 45);
  }
  while (!in_turn.follow_moves(7)) continue;
  const Map copy = asked_late;
  ASSERT_EQ(asked_early.landmarks(), asked_late.landmarks());
  for (const int l : asked_early.landmarks()) {
    for (const Map* other : std::array<const Map*, 3>{&asked_late, &in_turn, &copy}) {
      EXPECT_EQ(asked_early.landmark(l).position, other->landmark(l).position) << l;
      EXPECT_EQ(asked_early.landmark(l).max_distance, other->landmark(l).max_distance) << l;
    }
  }
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/localization/alignment.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "dkp_slam/optimization/test_scene.h"

namespace dkp_slam {
namespace {

using testing::Scene;

struct AlignCamera : ::testing::Test {
  Scene scene{100};
  Se3 truth = scene.random_pose(0.5, 0.3);
  std::vector<PoseObservation> observations;

  AlignCamera() {
    for (const Eigen::Vector3d& p : scene.points)
      observations.push_back({p, scene.exact(truth, p)});
  }
  /// The first so many observations are matched to the wrong landmark.
  void spoil(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      observations[i].landmark = scene.points[(i + 37) % scene.points.size()];
    }
  }
  std::optional<Alignment> align(std::uint64_t seed = 1) const {
    return align_camera(scene.camera, {}, observations, {}, seed);
  }
  double error(const Alignment& a) const {
    return (a.camera_from_world * truth.inverse()).log().norm();
  }
};

TEST_F(AlignCamera, ExactObservationsGiveTheExactPose) {
  const auto found = align();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 100);
  EXPECT_LT(error(*found), 1e-9);
}

TEST_F(AlignCamera, FourFifthsMayBeWrong) {
  spoil(80);
  const auto found = align();
  ASSERT_TRUE(found);
  EXPECT_LT(error(*found), 0.01);
  for (std::size_t i = 80; i < 100; ++i) EXPECT_TRUE(found->inlier[i]);
  EXPECT_LE(found->inliers, 25);  // a wrong match may end near by chance
}

TEST_F(AlignCamera, NoisyDepthsAverageOut) {
  spoil(50);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (PoseObservation& o : observations) {
    o.seen.depth *= 1.0 + 0.01 * unit(scene.random);
    o.seen.pixel += Eigen::Vector2d(unit(scene.random), unit(scene.random));
  }
  const auto found = align();
  ASSERT_TRUE(found);
  EXPECT_GE(found->inliers, 45);
  EXPECT_LT(error(*found), 0.02);
}

TEST_F(AlignCamera, ObservationsWithoutDepthCountAsWell) {
  for (std::size_t i = 10; i < 100; ++i) observations[i].seen.depth = 0.0;
  const auto found = align();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 100);
  EXPECT_LT(error(*found), 1e-9);
}

TEST_F(AlignCamera, NothingWhereTooFewAgree) {
  spoil(95);
  EXPECT_FALSE(align());
  observations.resize(2);
  EXPECT_FALSE(align());
  observations.clear();
  EXPECT_FALSE(align());
}

TEST_F(AlignCamera, NothingWithoutDepth) {
  for (PoseObservation& o : observations) o.seen.depth = 0.0;
  EXPECT_FALSE(align());
}

TEST_F(AlignCamera, SameSeedSameResult) {
  spoil(60);
  for (PoseObservation& o : observations) o.seen.depth *= 1.004;
  const auto first = align(3), second = align(3);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->camera_from_world.translation, second->camera_from_world.translation);
  EXPECT_EQ(first->inlier, second->inlier);
}

}  // namespace
}  // namespace dkp_slam

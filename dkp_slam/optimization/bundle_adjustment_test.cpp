#include "dkp_slam/optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "dkp_slam/optimization/test_scene.h"

namespace dkp_slam {
namespace {

using testing::Scene;

struct Truth {
  std::vector<Se3> poses;
  BundleProblem problem;
};

/// Six cameras about the origin, the first fixed at the truth, the others and all points disturbed.
Truth disturbed(Scene& scene) {
  Truth truth;
  for (int k = 0; k < 6; ++k) {
    truth.poses.push_back(k == 0 ? Se3() : scene.random_pose(0.3, 0.1));
    const Se3 start = k == 0 ? Se3() : scene.random_pose(0.02, 0.01) * truth.poses.back();
    truth.problem.poses.push_back({k, start, k == 0});
  }
  std::normal_distribution<double> noise(0.0, 0.02);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const Eigen::Vector3d off(noise(scene.random), noise(scene.random), noise(scene.random));
    truth.problem.points.push_back({static_cast<int>(i), scene.points[i] + off});
    for (int k = 0; k < 6; ++k) {
      truth.problem.sightings.push_back(
          {k, static_cast<int>(i), scene.exact(truth.poses[k], scene.points[i])});
    }
  }
  return truth;
}

TEST(BundleAdjustment, RecoversPosesAndPoints) {
  Scene scene(120);
  Truth truth = disturbed(scene);
  const BundleSolution s = adjust_bundle(scene.camera, {}, truth.problem, {30, true});
  ASSERT_TRUE(s.usable);
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT((s.poses[k].camera_from_world * truth.poses[k].inverse()).log().norm(), 1e-4);
  }
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    EXPECT_LT((s.points[i].position - scene.points[i]).norm(), 1e-3);
  }
}

TEST(BundleAdjustment, FixedPosesStay) {
  Scene scene(60);
  Truth truth = disturbed(scene);
  const BundleSolution s = adjust_bundle(scene.camera, {}, truth.problem);
  EXPECT_EQ((s.poses[0].camera_from_world.log()).norm(), 0.0);
}

TEST(BundleAdjustment, FindsTheWrongSightings) {
  Scene scene(120);
  Truth truth = disturbed(scene);
  for (std::size_t i = 0; i < truth.problem.sightings.size(); i += 17) {
    truth.problem.sightings[i].seen.pixel.x() += 25.0;
  }
  const BundleSolution s = adjust_bundle(scene.camera, {}, truth.problem, {30, true});
  for (std::size_t i = 0; i < s.outlier.size(); ++i)
    EXPECT_EQ(bool(s.outlier[i]), i % 17 == 0) << i;
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT((s.poses[k].camera_from_world * truth.poses[k].inverse()).log().norm(), 1e-3);
  }
}

TEST(BundleAdjustment, SameProblemSameBits) {
  Scene scene(80);
  Truth truth = disturbed(scene);
  const BundleSolution a = adjust_bundle(scene.camera, {}, truth.problem);
  const BundleSolution b = adjust_bundle(scene.camera, {}, truth.problem);
  for (std::size_t i = 0; i < a.points.size(); ++i)
    EXPECT_EQ(a.points[i].position, b.points[i].position);
}

TEST(BundleAdjustment, AskedToStopItSaysUnusable) {
  Scene scene(80);
  Truth truth = disturbed(scene);
  const std::atomic<bool> stop{true};
  EXPECT_FALSE(adjust_bundle(scene.camera, {}, truth.problem, {}, &stop).usable);
}

TEST(BundleAdjustment, NothingToDoIsNotUsable) {
  EXPECT_FALSE(adjust_bundle(Scene(1).camera, {}, BundleProblem{}).usable);
}

}  // namespace
}  // namespace dkp_slam

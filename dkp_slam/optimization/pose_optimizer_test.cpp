#include "dkp_slam/optimization/pose_optimizer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "dkp_slam/optimization/test_scene.h"

namespace dkp_slam {
namespace {

using testing::Scene;

TEST(PoseOptimizer, ExactObservationsGiveTheExactPose) {
  Scene scene(100);
  const Se3 truth = scene.random_pose(0.2, 0.2);
  std::vector<PoseObservation> seen;
  for (const auto& p : scene.points) seen.push_back({p, scene.exact(truth, p)});
  const PoseEstimate e = optimize_pose(scene.camera, {}, Se3(), seen);
  EXPECT_LT((e.camera_from_world * truth.inverse()).log().norm(), 1e-8);
  EXPECT_EQ(e.inliers, 100);
}

TEST(PoseOptimizer, WithoutDepthItStillSolves) {
  Scene scene(50);
  const Se3 truth = scene.random_pose(0.1, 0.1);
  std::vector<PoseObservation> seen;
  for (const auto& p : scene.points) {
    seen.push_back({p, scene.exact(truth, p)});
    seen.back().seen.depth = 0.0;
  }
  EXPECT_LT((optimize_pose(scene.camera, {}, Se3(), seen).camera_from_world * truth.inverse())
                .log()
                .norm(),
            1e-7);
}

TEST(PoseOptimizer, AThirdOfWrongMatchesIsFoundAndLeftOut) {
  Scene scene(150);
  const Se3 truth = scene.random_pose(0.05, 0.05);
  std::vector<PoseObservation> seen;
  std::uniform_real_distribution<double> off(20.0, 60.0);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    seen.push_back({scene.points[i], scene.exact(truth, scene.points[i])});
    if (i % 3 == 0)
      seen.back().seen.pixel += Eigen::Vector2d(off(scene.random), -off(scene.random));
  }
  const PoseEstimate e = optimize_pose(scene.camera, {}, Se3(), seen);
  EXPECT_LT((e.camera_from_world * truth.inverse()).log().norm(), 1e-6);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(bool(e.inlier[i]), i % 3 != 0);
}

TEST(PoseOptimizer, WrongDepthsAtEdgesDoNotPullThePose) {
  Scene scene(150);
  const Se3 truth = scene.random_pose(0.05, 0.05);
  std::vector<PoseObservation> seen;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    seen.push_back({scene.points[i], scene.exact(truth, scene.points[i])});
    if (i % 5 == 0) seen.back().seen.depth += 0.8;
  }
  const PoseEstimate e = optimize_pose(scene.camera, {}, Se3(), seen);
  EXPECT_LT((e.camera_from_world * truth.inverse()).log().norm(), 2e-4);
  EXPECT_EQ(e.inliers, 150);
}

TEST(PoseOptimizer, TooFewObservationsLeaveThePoseAlone) {
  Scene scene(2);
  std::vector<PoseObservation> seen;
  for (const auto& p : scene.points) seen.push_back({p, scene.exact(Se3(), p)});
  EXPECT_EQ(optimize_pose(scene.camera, {}, Se3(), seen).inliers, 0);
}

TEST(PoseInformation, OfOneLandmarkStraightAhead) {
  const Scene scene(0);
  const Eigen::Vector3d point(0.0, 0.0, 2.0);
  const MeasurementModel model;
  const auto h = pose_information(scene.camera, model, Se3(), {{point, scene.exact(Se3(), point)}});
  // A metre to the side is fx / z pixels; a radian about the vertical is fx pixels.
  const double pixels = 500.0 / 2.0;
  EXPECT_NEAR(h(0, 0), pixels * pixels, 1e-6);
  EXPECT_NEAR(h(1, 1), pixels * pixels, 1e-6);
  EXPECT_NEAR(h(2, 2), std::pow(model.depth_sigma(scene.camera, 2.0), -2.0), 1e-6);
  EXPECT_NEAR(h(3, 3), 500.0 * 500.0, 1e-6);
  EXPECT_NEAR(h(0, 4), pixels * 500.0, 1e-6);  // one looks like the other
  EXPECT_NEAR(h(5, 5), 0.0, 1e-12);            // a turn about the axis leaves it where it is
}

TEST(PoseInformation, GrowsWithTheLandmarks) {
  const Scene scene(100);
  std::vector<PoseObservation> seen;
  for (const auto& p : scene.points) seen.push_back({p, scene.exact(Se3(), p)});
  std::vector<PoseObservation> twice = seen;
  twice.insert(twice.end(), seen.begin(), seen.end());
  const auto once = pose_information(scene.camera, {}, Se3(), seen);
  EXPECT_TRUE(pose_information(scene.camera, {}, Se3(), twice).isApprox(2.0 * once, 1e-12));
}

}  // namespace
}  // namespace dkp_slam

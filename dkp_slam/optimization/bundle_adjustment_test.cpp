#include "dkp_slam/optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "dkp_slam/optimization/dense_bundle.h"
#include "dkp_slam/optimization/sparse_bundle.h"
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

TEST(BundleAdjustment, APoseThatSharesAHandfulOfPointsStays) {
  // The last one shares eight points with the others, five of them matched wrongly; what else it
  // sees, it alone sees, and wrongly.
  Scene scene(120);
  Truth truth = disturbed(scene);
  BundleProblem& problem = truth.problem;
  std::erase_if(problem.sightings, [](const auto& s) { return s.pose == 5 && s.point >= 8; });
  for (auto& s : problem.sightings) {
    if (s.pose == 5 && s.point < 5) s.seen.pixel += Eigen::Vector2d(60.0 * s.point - 90.0, 80.0);
  }
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d alone = scene.points[static_cast<std::size_t>(i + 40)];
    problem.points.push_back({200 + i, alone});
    problem.sightings.push_back(
        {5, static_cast<int>(problem.points.size()) - 1, scene.exact(truth.poses[5], alone * 1.1)});
  }
  BundleOptions free{30, true}, held{30, true};
  free.least_shared = 0;
  const BundleSolution thrown = adjust_bundle(scene.camera, {}, problem, free);
  const BundleSolution s = adjust_bundle(scene.camera, {}, problem, held);
  ASSERT_TRUE(s.usable);
  const auto error = [&](const BundleSolution& of, std::size_t k) {
    return (of.poses[k].camera_from_world * truth.poses[k].inverse()).log().norm();
  };
  EXPECT_GT(error(thrown, 5), 0.1);
  const Se3 &before = problem.poses[5].camera_from_world, &after = s.poses[5].camera_from_world;
  EXPECT_EQ(after.translation, before.translation);
  EXPECT_EQ(after.rotation.coeffs(), before.rotation.coeffs());
  EXPECT_TRUE(s.poses[5].fixed);
  EXPECT_EQ(s.points.back().position, problem.points.back().position);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_LT(error(s, k), 1e-3) << k;
}

TEST(BundleAdjustment, WhereAllPosesShareAHandfulPointsAloneMove) {
  Scene scene(5);
  const Truth truth = disturbed(scene);
  const BundleSolution s = adjust_bundle(scene.camera, {}, truth.problem);
  ASSERT_TRUE(s.usable);
  for (std::size_t k = 0; k < s.poses.size(); ++k) {
    EXPECT_EQ(s.poses[k].camera_from_world.translation,
              truth.problem.poses[k].camera_from_world.translation);
  }
  double moved = 0.0;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    moved += (s.points[i].position - truth.problem.points[i].position).norm();
  }
  EXPECT_GT(moved, 0.0);
}

/// Noise, wrong pixels, wrong and missing depths, a point of one sighting, two fixed poses.
Truth noisy(Scene& scene) {
  Truth truth = disturbed(scene);
  std::normal_distribution<double> noise(0.0, 1.0);
  truth.problem.poses[3].fixed = true;
  auto& sightings = truth.problem.sightings;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    Observation& seen = sightings[i].seen;
    seen.pixel += Eigen::Vector2d(noise(scene.random), noise(scene.random));
    seen.depth += 0.01 * noise(scene.random);
    if (i % 13 == 0) seen.pixel.x() += 20.0;
    if (i % 11 == 0) seen.depth += 0.5;
    if (i % 7 == 0) seen.depth = 0.0;
  }
  sightings.resize(sightings.size() - 5);
  return truth;
}

TEST(BundleAdjustment, DenseAndSparseFindTheSameMinimum) {
  Scene scene(150);
  const Truth truth = noisy(scene);
  const BundleSolution start{truth.problem.poses, truth.problem.points,
                             std::vector<char>(truth.problem.sightings.size(), 0), false};
  BundleSolution dense = start, sparse = start;
  ASSERT_TRUE(solve_dense_bundle(scene.camera, {}, truth.problem, 60, nullptr, dense));
  ASSERT_TRUE(solve_sparse_bundle(scene.camera, {}, truth.problem, 60, nullptr, sparse));
  for (std::size_t k = 0; k < dense.poses.size(); ++k) {
    const Se3 &a = dense.poses[k].camera_from_world, &b = sparse.poses[k].camera_from_world;
    EXPECT_LT((a * b.inverse()).log().norm(), 2e-4) << k;
  }
  for (std::size_t i = 0; i + 1 < dense.points.size(); ++i) {
    EXPECT_LT((dense.points[i].position - sparse.points[i].position).norm(), 5e-3) << i;
  }
  EXPECT_EQ(dense.poses[0].camera_from_world.log().norm(), 0.0);
}

TEST(BundleAdjustment, DenseStepsAreCeresSteps) {
  Scene scene(150);
  const Truth truth = noisy(scene);
  const BundleSolution start{truth.problem.poses, truth.problem.points,
                             std::vector<char>(truth.problem.sightings.size(), 0), false};
  BundleSolution dense = start, sparse = start;
  solve_dense_bundle(scene.camera, {}, truth.problem, 1, nullptr, dense);
  solve_sparse_bundle(scene.camera, {}, truth.problem, 1, nullptr, sparse);
  for (std::size_t k = 1; k < dense.poses.size(); ++k) {
    const Se3& from = start.poses[k].camera_from_world;
    const Vector6d a = (dense.poses[k].camera_from_world * from.inverse()).log();
    const Vector6d b = (sparse.poses[k].camera_from_world * from.inverse()).log();
    EXPECT_LE((a - b).norm(), 1e-3 * b.norm()) << k;
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

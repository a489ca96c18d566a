#include "dkp_slam/tracking/path_smoother.h"

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

constexpr int enough = 1000;  // landmarks

/// A camera that is swung about, 30 times a second.
Se3 camera_at(std::size_t i) {
  const double t = static_cast<double>(i) / 30.0;
  Vector6d tangent;
  tangent << 0.3 * std::sin(t), 0.2 * std::cos(1.3 * t), 0.1 * t, 0.2 * std::sin(0.7 * t),
      0.5 * std::cos(0.9 * t), 0.1 * t;
  return Se3::exp(tangent);
}

std::vector<PathPose> true_path(std::size_t length) {
  std::vector<PathPose> path;
  for (std::size_t i = 0; i < length; ++i) {
    path.push_back({camera_at(i), std::nullopt, enough});
    if (i > 0) path.back().from_previous = camera_at(i) * camera_at(i - 1).inverse();
  }
  return path;
}

Vector6d error_at(const std::vector<PathPose>& path, std::size_t i) {
  return (path[i].camera_from_world * camera_at(i).inverse()).log();
}

TEST(PathSmoother, LeavesAPathThatAgreesWithItsMotions) {
  std::vector<PathPose> path = true_path(700);  // solved in three stretches
  smooth_path(path, {});
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_LT(error_at(path, i).norm(), 1e-9) << i;
}

TEST(PathSmoother, LeavesPosesBetweenWhichNoMotionIsKnown) {
  std::vector<PathPose> path = true_path(20);
  for (PathPose& p : path) p.from_previous.reset();
  path[7].camera_from_world.translation.x() += 0.2;
  const std::vector<PathPose> before = path;
  smooth_path(path, {});
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LT((path[i].camera_from_world * before[i].camera_from_world.inverse()).log().norm(),
              1e-12);
  }
}

/// Noise of the sizes that are assumed, on an endless chain: of a pose's variance p and a motion's
/// m what is left is p / sqrt(1 + 4 p / m), the mean of 1 / (1 / p + (2 - 2 cos w) / m) over w.
TEST(PathSmoother, LeavesTheNoiseThatIsDue) {
  PathSmootherOptions options;
  options.pose_translation = options.pose_rotation = 0.003;
  options.motion_translation = options.motion_rotation = 0.002;
  options.doubtful = 1e3;  // least squares, nothing else
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    Vector6d x;
    for (double& v : x) v = sigma * normal(random);
    return Se3::exp(x);
  };
  std::vector<PathPose> path = true_path(4000);
  for (PathPose& p : path) {
    p.camera_from_world = noise(options.pose_translation) * p.camera_from_world;
    if (p.from_previous) p.from_previous = noise(options.motion_translation) * *p.from_previous;
  }
  smooth_path(path, options);
  double squares = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) squares += error_at(path, i).squaredNorm();
  const double variance = squares / (6.0 * static_cast<double>(path.size()));
  const double p = 9e-6, m = 4e-6;
  EXPECT_NEAR(variance, p / std::sqrt(1.0 + 4.0 * p / m), 0.05 * variance);
}

TEST(PathSmoother, IsNotLedAstrayByOneMotionNorByOnePose) {
  const double far = 0.1;  // metres
  {
    std::vector<PathPose> path = true_path(60);
    path[30].from_previous->translation.x() += far;  // somebody filled the view, and walked
    smooth_path(path, {});
    for (std::size_t i = 0; i < 60; ++i) EXPECT_LT(error_at(path, i).norm(), 0.004) << i;
  }
  std::vector<PathPose> path = true_path(60);
  path[30].camera_from_world.translation.x() += far;
  smooth_path(path, {});
  for (std::size_t i = 0; i < 60; ++i) EXPECT_LT(error_at(path, i).norm(), 0.004) << i;
}

TEST(PathSmoother, BelievesLessInWhatRestsOnFewLandmarks) {
  const double off = 0.005;  // metres
  double error[2];
  for (const int landmarks : {enough, 20}) {
    std::vector<PathPose> path = true_path(60);
    for (std::size_t i = 25; i < 35; ++i) {
      path[i].landmarks = landmarks;
      path[i].camera_from_world.translation.x() += i % 2 == 0 ? off : -off;
    }
    smooth_path(path, {});
    double worst = 0.0;
    for (std::size_t i = 0; i < 60; ++i) worst = std::max(worst, error_at(path, i).norm());
    error[landmarks == enough ? 0 : 1] = worst;
  }
  EXPECT_LT(error[0], 0.5 * off);
  EXPECT_LT(error[1], 0.2 * off);
}

TEST(PathSmoother, DoesNothingWhenToldSo) {
  std::vector<PathPose> path = true_path(30);
  path[10].camera_from_world.translation.y() += 0.01;
  PathSmootherOptions options;
  options.smooth = false;
  smooth_path(path, options);
  EXPECT_NEAR(error_at(path, 10).norm(), 0.01, 1e-9);
  std::vector<PathPose> nothing;
  smooth_path(nothing, {});
  EXPECT_TRUE(nothing.empty());
}

}  // namespace
}  // namespace dkp_slam

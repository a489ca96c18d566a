#include "dkp_slam/tracking/path_smoother.h"

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

constexpr int enough = 1000;   // landmarks
constexpr double rate = 30.0;  // Hz

double stamp(std::size_t i) { return 10.0 + static_cast<double>(i) / rate; }

/// A camera that is swung about.
Se3 camera_at(std::size_t i) {
  const double t = static_cast<double>(i) / rate;
  Vector6d tangent;
  tangent << 0.3 * std::sin(t), 0.2 * std::cos(1.3 * t), 0.1 * t, 0.2 * std::sin(0.7 * t),
      0.5 * std::cos(0.9 * t), 0.1 * t;
  return Se3::exp(tangent);
}

std::vector<PathPose> true_path(std::size_t length) {
  std::vector<PathPose> path;
  for (std::size_t i = 0; i < length; ++i) {
    path.push_back({stamp(i), camera_at(i), std::nullopt, enough});
    if (i > 0) path.back().from_previous = camera_at(i) * camera_at(i - 1).inverse();
  }
  return path;
}

Vector6d error_at(const std::vector<PathPose>& path, std::size_t i) {
  return (path[i].camera_from_world * camera_at(i).inverse()).log();
}

/// As if the camera had no mass.
PathSmootherOptions weightless() {
  PathSmootherOptions options;
  options.acceleration = options.angular_acceleration = 1e5;
  return options;
}

struct Noise {
  std::mt19937 random{7};
  std::normal_distribution<double> normal;

  Vector6d tangent(double sigma) {
    Vector6d x;
    for (double& v : x) v = sigma * normal(random);
    return x;
  }
  Se3 pose(double sigma) { return Se3::exp(tangent(sigma)); }
};

TEST(PathSmoother, LeavesAPathThatAgreesWithItsMotions) {
  std::vector<PathPose> path = true_path(700);  // solved in three stretches
  smooth_path(path, weightless());
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_LT(error_at(path, i).norm(), 1e-9) << i;
}

/// Also where frames are missing, and of motions nothing is known.
TEST(PathSmoother, LeavesAPathOfConstantVelocity) {
  Vector6d velocity;
  velocity << 0.4, -0.2, 0.3, 0.5, 1.0, -0.3;
  std::vector<PathPose> path, truth;
  for (std::size_t i = 0; i < 300; ++i) {
    if (i % 7 == 3 || (i > 100 && i < 130)) continue;
    path.push_back({stamp(i), Se3::exp((stamp(i) - stamp(0)) * velocity), std::nullopt, enough});
  }
  truth = path;
  smooth_path(path, {});
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Se3 off = path[i].camera_from_world * truth[i].camera_from_world.inverse();
    EXPECT_LT(off.log().norm(), 1e-9) << i;
  }
}

TEST(PathSmoother, WithoutMassAndMotionsPosesStayWhereTheyAre) {
  std::vector<PathPose> path = true_path(20);
  for (PathPose& p : path) p.from_previous.reset();
  path[7].camera_from_world.translation.x() += 0.2;
  const std::vector<PathPose> before = path;
  smooth_path(path, weightless());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LT((path[i].camera_from_world * before[i].camera_from_world.inverse()).log().norm(),
              1e-7);
  }
  std::vector<PathPose> one(before.begin(), before.begin() + 1);
  smooth_path(one, {});
  EXPECT_LT(error_at(one, 0).norm(), 1e-12);
}

/// Noise of the sizes that are assumed, on an endless chain: of a pose's variance p and a motion's
/// m what is left is p / sqrt(1 + 4 p / m), the mean of 1 / (1 / p + (2 - 2 cos w) / m) over w.
TEST(PathSmoother, LeavesTheNoiseThatIsDue) {
  PathSmootherOptions options = weightless();
  options.pose_translation = options.pose_rotation = 0.003;
  options.motion_translation = options.motion_rotation = 0.002;
  options.doubtful = 1e3;  // least squares, nothing else
  Noise noise;
  std::vector<PathPose> path = true_path(4000);
  for (PathPose& p : path) {
    p.camera_from_world = noise.pose(options.pose_translation) * p.camera_from_world;
    if (p.from_previous)
      p.from_previous = noise.pose(options.motion_translation) * *p.from_previous;
  }
  smooth_path(path, options);
  double squares = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) squares += error_at(path, i).squaredNorm();
  const double variance = squares / (6.0 * static_cast<double>(path.size()));
  const double p = 9e-6, m = 4e-6;
  EXPECT_NEAR(variance, p / std::sqrt(1.0 + 4.0 * p / m), 0.05 * variance);
}

/// A camera whose velocity is a Wiener process of density q, seen with white noise of density r
/// (its variance times the time between frames): the mean of r q / (q + r w^4) over all
/// frequencies w, r (q / r)^(1/4) / (2 sqrt 2).
TEST(PathSmoother, LeavesTheNoiseThatIsDueToACameraWithMass) {
  PathSmootherOptions options;
  options.pose_translation = options.pose_rotation = 0.003;
  options.acceleration = options.angular_acceleration = 0.7;
  options.doubtful = 1e3;
  Noise noise;
  const double q = 0.7 * 0.7 / rate, r = 9e-6 / rate;
  constexpr int between = 20;  // steps of the process from frame to frame
  std::vector<Se3> truth(4000);
  std::vector<PathPose> path;
  Vector6d velocity = Vector6d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0) truth[i] = truth[i - 1];
    for (int k = 0; i > 0 && k < between; ++k) {
      velocity += noise.tangent(std::sqrt(q / (rate * between)));
      truth[i] = Se3::exp(velocity / (rate * between)) * truth[i];
    }
    path.push_back({stamp(i), noise.pose(0.003) * truth[i], std::nullopt, enough});
  }
  smooth_path(path, options);
  double squares = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    squares += (path[i].camera_from_world * truth[i].inverse()).log().squaredNorm();
  }
  const double variance = squares / (6.0 * static_cast<double>(path.size()));
  EXPECT_NEAR(variance, r * std::pow(q / r, 0.25) / (2.0 * std::sqrt(2.0)), 0.05 * variance);
}

TEST(PathSmoother, FollowsACameraThatIsKnockedAgainstSomething) {
  std::vector<PathPose> path;
  const auto way = [](std::size_t i) { return i < 50 ? static_cast<double>(i) / rate : 50 / rate; };
  for (std::size_t i = 0; i < 100; ++i) {  // a metre a second, then none
    path.push_back({stamp(i), Se3(), std::nullopt, enough});
    path.back().camera_from_world.translation.x() = -way(i);
    if (i > 0) path.back().from_previous = Se3({1, 0, 0, 0}, {way(i - 1) - way(i), 0, 0});
  }
  smooth_path(path, {});
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(path[i].camera_from_world.translation.x(), -way(i), 0.008) << i;
  }
}

TEST(PathSmoother, DoesNotTieAPlaceThatWasRecognisedToTheOneBefore) {
  std::vector<PathPose> path;
  for (std::size_t i = 0; i < 60; ++i) {
    const double way = stamp(i) - stamp(0) + (i < 30 ? 0.0 : 0.5);
    path.push_back({stamp(i), Se3({1, 0, 0, 0}, {way, 0, 0}), std::nullopt, enough, i != 30});
  }
  const std::vector<PathPose> before = path;
  smooth_path(path, {});
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(path[i].camera_from_world.translation.x(),
                before[i].camera_from_world.translation.x(), 1e-9)
        << i;
  }
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

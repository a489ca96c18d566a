#include "dkp_slam/synth/path/motion.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/synth/path/pose_spline.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

/// Means over two minutes of three seeds.
struct Behaviour {
  double speed = 0.0, turning = 0.0;  ///< m/s, rad/s
  double highest_speed = 0.0, highest_turning = 0.0;
  Vector3d low = Vector3d::Constant(1e9), high = Vector3d::Constant(-1e9);
  double worst_aim = 0.0;  ///< radians between the view and +y, a little down
};

Behaviour behaviour(SyntheticMotion motion) {
  constexpr double step = 0.1;
  Behaviour b;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const CameraPath pose = hand_motion(motion, seed);
    for (double t = 1.0; t < 120.0; t += step, ++count) {
      const Se3 here = pose(t), move = here.inverse() * pose(t + step);
      b.speed += move.translation.norm() / step;
      b.turning += move.angle() / step;
      b.highest_speed = std::max(b.highest_speed, move.translation.norm() / step);
      b.highest_turning = std::max(b.highest_turning, move.angle() / step);
      b.low = b.low.cwiseMin(here.translation);
      b.high = b.high.cwiseMax(here.translation);
      const Vector3d ahead = here.rotation * Vector3d::UnitZ();
      const Vector3d desk = (Vector3d(0.0, 2.0, 0.9) - here.translation).normalized();
      b.worst_aim = std::max(b.worst_aim, std::acos(ahead.dot(desk)));
    }
  }
  b.speed /= count;
  b.turning /= count;
  return b;
}

TEST(CameraView, HasTheAxesOfACamera) {
  const Eigen::Quaterniond level = camera_view(0.0, 0.0, 0.0);
  EXPECT_TRUE((level * Vector3d::UnitX()).isApprox(Vector3d::UnitX()));
  EXPECT_TRUE((level * Vector3d::UnitY()).isApprox(-Vector3d::UnitZ()));
  EXPECT_TRUE((level * Vector3d::UnitZ()).isApprox(Vector3d::UnitY()));
  EXPECT_GT((camera_view(0.0, 0.3, 0.0) * Vector3d::UnitZ()).z(), 0.29);   // looks up
  EXPECT_LT((camera_view(0.3, 0.0, 0.0) * Vector3d::UnitZ()).x(), -0.29);  // to the left
  EXPECT_GT((camera_view(0.0, 0.0, 0.3) * Vector3d::UnitX()).z(), 0.29);   // right side up
}

struct Recording {
  SyntheticMotion motion;
  double speed, turning;  ///< mean over tenths of a second, m/s and rad/s
  double highest_speed, highest_turning;
};

// What scripts/motion_spectrum.py says of the benchmark's freiburg3_walking_xyz, sitting_xyz,
// walking_rpy, walking_halfsphere and walking_static.
TEST(HandMotion, IsAsFastAsTheRecordings) {
  for (const Recording& r : {Recording{SyntheticMotion::xyz, 0.227, 0.193, 0.65, 1.16},
                             Recording{SyntheticMotion::slow_xyz, 0.139, 0.135, 0.32, 0.79},
                             Recording{SyntheticMotion::rpy, 0.103, 0.427, 0.44, 1.80},
                             Recording{SyntheticMotion::halfsphere, 0.235, 0.391, 0.51, 1.44},
                             Recording{SyntheticMotion::still, 0.018, 0.069, 0.07, 0.35}}) {
    SCOPED_TRACE(static_cast<int>(r.motion));
    const Behaviour b = behaviour(r.motion);
    EXPECT_NEAR(b.speed, r.speed, 0.2 * r.speed);
    EXPECT_NEAR(b.turning, r.turning, 0.2 * r.turning);
    EXPECT_LT(b.highest_speed, 1.5 * r.highest_speed);
    EXPECT_LT(b.highest_turning, 1.5 * r.highest_turning);
  }
}

TEST(HandMotion, StaysBeforeTheDeskAndLooksAtIt) {
  for (const SyntheticMotion motion :
       {SyntheticMotion::xyz, SyntheticMotion::slow_xyz, SyntheticMotion::rpy,
        SyntheticMotion::halfsphere, SyntheticMotion::still}) {
    SCOPED_TRACE(static_cast<int>(motion));
    const Behaviour b = behaviour(motion);
    EXPECT_GT(b.low.x(), -1.3);
    EXPECT_LT(b.high.x(), 1.3);
    EXPECT_GT(b.low.y(), -1.9);
    EXPECT_LT(b.high.y(), 0.2);
    EXPECT_GT(b.low.z(), 0.5);
    EXPECT_LT(b.high.z(), 2.3);
    EXPECT_LT(b.worst_aim, 60.0 * degree);
  }
}

TEST(HandMotion, StartsAtRestAndIsSmooth) {
  for (const SyntheticMotion motion :
       {SyntheticMotion::xyz, SyntheticMotion::slow_xyz, SyntheticMotion::rpy,
        SyntheticMotion::halfsphere, SyntheticMotion::still}) {
    const CameraPath pose = hand_motion(motion, 4);
    const Vector6d first = (pose(0.0).inverse() * pose(0.002)).log() / 0.002;
    EXPECT_LT(first.norm(), 0.004);
    EXPECT_EQ(pose(-1.0).translation, pose(0.0).translation);
    // No jerk: from one 60th of a second to the next the speed changes little.
    constexpr double step = 1.0 / 60.0;
    for (double t = 0.0; t < 20.0; t += step) {
      const Vector6d a = (pose(t).inverse() * pose(t + step)).log();
      const Vector6d b = (pose(t + step).inverse() * pose(t + 2.0 * step)).log();
      ASSERT_LT((b - a).norm() / (step * step), 12.0) << "at " << t;
    }
  }
}

TEST(HandMotion, SeedsDiffer) {
  const auto distance = [](std::uint64_t a, std::uint64_t b) {
    return (hand_motion(SyntheticMotion::xyz, a)(5.0).translation -
            hand_motion(SyntheticMotion::xyz, b)(5.0).translation)
        .norm();
  };
  EXPECT_EQ(distance(3, 3), 0.0);
  EXPECT_GT(distance(3, 4), 0.02);
}

TEST(HandMotion, FollowsItsStandpoint) {
  for (const SyntheticMotion motion : {SyntheticMotion::xyz, SyntheticMotion::halfsphere}) {
    Standpoint at;
    const CameraPath here = hand_motion(motion, 1, at);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Vector3d::UnitZ()));
    at.position = turn * at.position + Vector3d(1.0, 2.0, 0.0);
    at.heading = 1.0;
    const Se3 moved = Se3(turn, Vector3d(1.0, 2.0, 0.0)) * here(7.0);
    EXPECT_LT((moved.inverse() * hand_motion(motion, 1, at)(7.0)).log().norm(), 1e-9);
  }
}

TEST(PoseSpline, KeepsStraightLinesAndEndsAtRest) {
  std::vector<Se3> line;
  for (int i = 0; i < 20; ++i) {
    line.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(0.05 * i, Vector3d::UnitY())),
                      Vector3d(0.1 * i, 0.0, 1.0));
    if (i % 3 == 0) line.back().rotation.coeffs() *= -1.0;  // the same rotation
  }
  const PoseSpline spline(line, 0.5);
  for (double t = 0.5; t < 9.0; t += 0.07) {
    EXPECT_NEAR(spline.at(t).translation.x(), 0.2 * t, 1e-9);
    EXPECT_NEAR(spline.at(t).angle(), 0.1 * t, 1e-4);
  }
  EXPECT_LT((spline.at(100.0).inverse() * line.back()).log().norm(), 1e-9);
  EXPECT_LT((spline.at(-5.0).inverse() * line.front()).log().norm(), 1e-9);
}

TEST(PoseSpline, ClosedBeginsAnew) {
  std::vector<Se3> knots(5);
  for (int i = 0; i < 5; ++i) knots[std::size_t(i)].translation.x() = i * i;
  const PoseSpline spline(knots, 1.0, true);
  for (double t = 0.0; t < 5.0; t += 0.3) {
    EXPECT_NEAR(spline.at(t).translation.x(), spline.at(t + 5.0).translation.x(), 1e-9);
  }
  EXPECT_NEAR(spline.at(5.0 - 1e-9).translation.x(), spline.at(5.0 + 1e-9).translation.x(), 1e-6);
}

TEST(WalkingMotion, GoesAroundAtItsPaceNearItsWayPoints) {
  const std::vector<Vector2d> square = {{0, 0}, {5, 0}, {5, 4}, {0, 4}};
  const double length = walking_length(square);
  EXPECT_GT(length, 15.5);
  EXPECT_LT(length, 18.0);
  const CameraPath pose = walking_motion(square, 1);
  double way = 0.0, highest_turning = 0.0;
  constexpr double step = 0.1;
  for (double t = 0.0; t < 60.0; t += step) {
    const Vector3d here = pose(t).translation;
    const Vector3d move = pose(t + step).translation - here;
    way += move.head<2>().norm();
    highest_turning =
        std::max(highest_turning, (pose(t).inverse() * pose(t + step)).angle() / step);
    // Distance from the square's sides: on them, but for rounded corners and the sway.
    const double off = std::min({std::abs(here.x()), std::abs(here.x() - 5.0), std::abs(here.y()),
                                 std::abs(here.y() - 4.0)});
    EXPECT_LT(off, 0.32);
    EXPECT_NEAR(here.z(), 1.40, 0.06);
    if (t > 2.0) {
      // It looks where it goes.
      const Vector3d ahead = pose(t + 0.5 * step).rotation * Vector3d::UnitZ();
      EXPECT_GT(ahead.head<2>().normalized().dot(move.head<2>().normalized()), 0.60);
    }
  }
  EXPECT_NEAR(way / 59.5, camera_walking_speed, 0.05);
  EXPECT_LT(highest_turning, 1.2);
  // One round later it is in the same place.
  const double round = length / camera_walking_speed;
  EXPECT_LT((pose(10.0).translation - pose(10.0 + round).translation).norm(), 0.12);
}

/// A path as a motion capture would record it, in a world of its own.
Trajectory captured(double seconds, double rate, double jitter) {
  cv::RNG rng(9);
  Trajectory poses;
  const Se3 elsewhere(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Vector3d::UnitZ())),
                      Vector3d(30.0, -8.0, 0.7));
  const CameraPath hand = hand_motion(SyntheticMotion::xyz, 12);
  for (int i = 0; i <= seconds * rate; ++i) {
    Vector6d noise;
    for (int k = 0; k < 6; ++k) noise[k] = rng.gaussian(jitter);
    StampedPose pose{5e8 + i / rate, elsewhere * hand(i / rate) * Se3::exp(noise)};
    if (i % 7 == 0) pose.world_from_camera.rotation.coeffs() *= -1.0;
    poses.push_back(pose);
  }
  return poses;
}

/// Largest distances (metres, radians) of a recorded motion from the hand's own, both relative to
/// their first second's end: the placement does not count.
std::pair<double, double> deviation(const RecordedMotion& motion) {
  const CameraPath hand = hand_motion(SyntheticMotion::xyz, 12);
  double distance = 0.0, angle = 0.0;
  const Se3 start = motion.motion(5.0), true_start = hand(5.0);
  for (double t = 0.2; t < motion.duration - 0.2; t += 0.013) {
    const Se3 a = start.inverse() * motion.motion(t), b = true_start.inverse() * hand(t);
    distance = std::max(distance, (a.translation - b.translation).norm());
    angle = std::max(angle, (a.inverse() * b).angle());
  }
  return {distance, angle};
}

TEST(RecordedMotion, IsTheRecordedPathPlacedBeforeTheDesk) {
  const RecordedMotion motion = recorded_motion(captured(20.0, 100.0, 0.0), "path");
  EXPECT_NEAR(motion.duration, 20.0, 1e-6);
  const auto [distance, angle] = deviation(motion);
  EXPECT_LT(distance, 0.002);
  EXPECT_LT(angle, 0.005);  // trembling of 5 Hz is smoothed a little
  const Standpoint at;
  Vector3d centre = Vector3d::Zero(), ahead = Vector3d::Zero();
  for (int i = 0; i < 200; ++i) {
    const Se3 pose = motion.motion(0.1 * i);
    centre += pose.translation / 200.0;
    ahead += pose.rotation * Vector3d::UnitZ() / 200.0;
  }
  EXPECT_LT((centre - at.position).norm(), 0.01);
  EXPECT_NEAR(std::atan2(-ahead.x(), ahead.y()), at.heading, 0.01);
}

TEST(RecordedMotion, SmoothsTheJitterOfMotionCapture) {
  constexpr double jitter = 0.0015;  // metres and radians of each axis: 0.8 pixels
  const auto [distance, angle] = deviation(recorded_motion(captured(20.0, 100.0, jitter), "path"));
  // Of thousands of moments the worst: 4 sigma of what is left.
  EXPECT_LT(distance, 0.006);
  EXPECT_LT(angle, 0.006);
  const RecordedMotion motion = recorded_motion(captured(20.0, 100.0, jitter), "path");
  const CameraPath hand = hand_motion(SyntheticMotion::xyz, 12);
  double turning = 0.0, true_turning = 0.0;
  for (double t = 1.0; t < 19.0; t += 0.05) {
    turning += (motion.motion(t).inverse() * motion.motion(t + 1.0 / 30.0)).angle();
    true_turning += (hand(t).inverse() * hand(t + 1.0 / 30.0)).angle();
  }
  EXPECT_LT(turning, true_turning * 1.35);
}

TEST(RecordedMotion, BridgesGapsWithoutAJump) {
  Trajectory poses = captured(20.0, 100.0, 0.0);
  const auto from = poses.begin() + 800;
  poses.erase(from, from + 70);  // 0.7 seconds
  const RecordedMotion motion = recorded_motion(poses, "path");
  const auto [distance, angle] = deviation(motion);
  EXPECT_LT(distance, 0.05);
  EXPECT_LT(angle, 0.05);
  constexpr double step = 0.01;
  for (double t = 7.5; t < 9.5; t += step) {
    const Vector6d a = (motion.motion(t).inverse() * motion.motion(t + step)).log();
    const Vector6d b = (motion.motion(t + step).inverse() * motion.motion(t + 2.0 * step)).log();
    EXPECT_LT((b - a).norm() / step, 0.25) << "at " << t;  // a change of speed
  }
}

TEST(RecordedMotion, TakesSparsePathsToo) {
  const auto [distance, angle] = deviation(recorded_motion(captured(20.0, 10.0, 0.0), "path"));
  EXPECT_LT(distance, 0.03);
  EXPECT_LT(angle, 0.03);
}

std::string refusal(const Trajectory& poses) {
  try {
    recorded_motion(poses, "my/path.txt");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(RecordedMotion, RefusesWhatIsNoCameraPathInARoom) {
  EXPECT_THAT(refusal(captured(0.5, 100.0, 0.0)), HasSubstr("my/path.txt: the path lasts 0.50 s"));
  EXPECT_THAT(refusal({}), HasSubstr("my/path.txt: the path lasts 0.00 s"));
  Trajectory sparse = {captured(20.0, 100.0, 0.0).front(), captured(20.0, 100.0, 0.0).back()};
  EXPECT_THAT(refusal(sparse), HasSubstr("too few"));
  Trajectory wide = captured(20.0, 100.0, 0.0);
  for (StampedPose& p : wide) p.world_from_camera.translation *= 30.0;
  EXPECT_THAT(refusal(wide), HasSubstr("does not fit the office"));
  Trajectory camera_world = captured(20.0, 100.0, 0.0);
  const Se3 first = camera_world.front().world_from_camera;
  for (StampedPose& p : camera_world) p.world_from_camera = first.inverse() * p.world_from_camera;
  EXPECT_THAT(refusal(camera_world), HasSubstr("z up"));
}

TEST(RecordedMotion, NamesFileAndLineOfABadFile) {
  const fs::path file = fs::path(::testing::TempDir()) / "recorded_motion.txt";
  const auto refusal_of = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      recorded_motion(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string good = "1.0 0 0 1.4 -0.7071068 0 0 0.7071068\n";
  EXPECT_THAT(refusal_of("# comment\n" + good + "1.1 0 0 1.4 0 0 0.7\n"),
              HasSubstr(file.string() + ":3: 7 fields"));
  EXPECT_THAT(refusal_of(good + "1.1 nan 0 1.4 0 0 0 1\n"), HasSubstr(file.string() + ":2: tx"));
  EXPECT_THAT(refusal_of(good), HasSubstr(file.string() + ": the path lasts"));
  EXPECT_THAT(refusal_of(""), HasSubstr(file.string() + ": no pose"));
  fs::remove(file);
  EXPECT_THAT(refusal_of(good + "1.9 0 0 1.4 -0.7071068 0 0 0.7071068\n"
                                "2.8 0 0 1.4 -0.7071068 0 0 0.7071068\n"),
              "");
  fs::remove(file);
  EXPECT_THROW(recorded_motion(file), Error);
}

}  // namespace
}  // namespace dkp_slam

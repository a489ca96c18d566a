#include "dkp_slam/synth/figure/figure_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/synth/figure/figure_test_scripts.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Kind = Activity::Kind;

FigureMotion motion_of(const FigureOptions& options) {
  return FigureMotion(options, random_look(options.seed));
}

Vector3d palm(const JointPoses& joints, int side) {
  return joints[of_side(Joint::left_hand, side)] * Vector3d(0.0, 0.0, -0.075);
}

TEST(FigureMotion, BonesKeepTheirLengths) {
  const FigureMotion motion = motion_of(busy_day(1));
  const std::vector<std::pair<Joint, Joint>> bones = {{Joint::left_upper_arm, Joint::left_forearm},
                                                      {Joint::right_forearm, Joint::right_hand},
                                                      {Joint::left_thigh, Joint::left_shin},
                                                      {Joint::right_shin, Joint::right_foot},
                                                      {Joint::pelvis, Joint::left_thigh},
                                                      {Joint::chest, Joint::right_upper_arm},
                                                      {Joint::neck, Joint::head},
                                                      {Joint::left_foot, Joint::left_toes}};
  for (double time = 0.0; time < 60.0; time += 0.1) {
    const JointPoses joints = motion.joints(time);
    for (const auto& [a, b] : bones) {
      const double length = (motion.rest()[a] - motion.rest()[b]).norm();
      EXPECT_NEAR((joints[a].translation - joints[b].translation).norm(), length, 1e-6);
    }
  }
}

TEST(FigureMotion, FeetDoNotSlide) {
  const FigureMotion motion = motion_of(walking(12.0));
  const double ground = motion.rest()[Joint::left_toes].z();
  for (const Joint toes : {Joint::left_toes, Joint::right_toes}) {
    Vector3d landed = Vector3d::Zero();
    bool down = false;
    double longest = 0.0;
    int steps = 0;
    for (double time = 0.0; time < 12.0; time += 0.01) {
      const Vector3d at = motion.joints(time)[toes].translation;
      const bool low = at.z() < ground + 0.004;
      if (low && !down) {
        landed = at;
        ++steps;
      }
      if (low) longest = std::max(longest, (at - landed).head<2>().norm());
      down = low;
    }
    EXPECT_LT(longest, 0.06);
    EXPECT_GE(steps, 8);
    EXPECT_LE(steps, 14);
  }
}

TEST(FigureMotion, LegsReachTheirFeetWhileWalking) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    FigureOptions options = walking(8.0);
    options.seed = seed;
    const FigureMotion motion = motion_of(options);
    double straightest = 0.0;
    for (double time = 2.0; time < 6.0; time += 0.01) {
      const JointPoses joints = motion.joints(time);
      const double leg =
          (motion.rest()[Joint::left_thigh] - motion.rest()[Joint::left_foot]).norm();
      const double reach =
          (joints[Joint::left_thigh].translation - joints[Joint::left_foot].translation).norm();
      straightest = std::max(straightest, reach / leg);
    }
    EXPECT_GT(straightest, 0.97) << "walks on bent knees";
  }
}

TEST(FigureMotion, ArmsSwingAgainstTheLegs) {
  const FigureMotion motion = motion_of(walking(12.0));
  double sum = 0.0;
  for (double time = 2.0; time < 8.0; time += 0.01) {
    const JointPoses joints = motion.joints(time);
    const double legs =
        joints[Joint::left_foot].translation.x() - joints[Joint::right_foot].translation.x();
    const double arms =
        joints[Joint::left_hand].translation.x() - joints[Joint::right_hand].translation.x();
    sum += legs * arms;
  }
  EXPECT_LT(sum / 600.0, -0.05);
}

TEST(FigureMotion, SitsOnTheSeat) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const FigureMotion motion = motion_of(seated(seed));
    const Vector2d ahead(std::cos(0.7), std::sin(0.7));
    for (const double time : {0.0, 2.0, 50.0}) {
      const JointPoses joints = motion.joints(time);
      const Vector3d hips =
          0.5 * (joints[Joint::left_thigh].translation + joints[Joint::right_thigh].translation);
      EXPECT_GT(hips.z(), 0.45 + 0.06);
      EXPECT_LT(hips.z(), 0.45 + 0.12);
      EXPECT_LT((hips.head<2>() - Vector2d(1.0, 2.0)).norm(), 0.10);
      const Vector3d knee = joints[Joint::left_shin].translation;
      EXPECT_GT((knee - hips).head<2>().dot(ahead), 0.3);
      EXPECT_GT(joints[Joint::head].translation.z(), 1.0);
    }
  }
}

TEST(FigureMotion, SitsDownAndGetsUp) {
  FigureOptions options;
  options.activities = {{Kind::sit, {2.0, 0.0}, 1.5, 3.0, Gesture::none},
                        {Kind::walk_to, {0.0, 0.0}, 0.0, 0.0, Gesture::none}};
  const FigureMotion motion = motion_of(options);
  const double standing = motion.joints(0.0)[Joint::pelvis].translation.z();
  double lowest = standing;
  for (double time = 0.0; time < 20.0; time += 0.1) {
    lowest = std::min(lowest, motion.joints(time)[Joint::pelvis].translation.z());
  }
  EXPECT_LT(lowest, 0.62);
  const JointPoses end = motion.joints(20.0);
  EXPECT_NEAR(end[Joint::pelvis].translation.z(), standing, 0.02);
  EXPECT_LT(motion.root(20.0).translation.norm(), 0.01);
}

TEST(FigureMotion, StandsUpright) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    FigureOptions options = doing(Gesture::none);
    options.seed = seed;
    const JointPoses joints = motion_of(options).joints(4.0);
    const auto z = [&](Joint joint) { return joints[joint].translation.z(); };
    EXPECT_GT(z(Joint::head), z(Joint::chest) + 0.2);
    EXPECT_GT(z(Joint::chest), z(Joint::pelvis) + 0.2);
    EXPECT_GT(z(Joint::pelvis), z(Joint::left_shin) + 0.3);
    EXPECT_GT(z(Joint::left_shin), z(Joint::left_foot) + 0.3);
    const Vector3d lean = joints[Joint::head].translation - joints[Joint::pelvis].translation;
    EXPECT_LT(lean.head<2>().norm(), 0.12);
  }
}

TEST(FigureMotion, HandsFollowTheGestures) {
  const auto joints_of = [](Gesture gesture) { return motion_of(doing(gesture)).joints(5.0); };
  const JointPoses phone = joints_of(Gesture::phone), wave = joints_of(Gesture::wave);
  const JointPoses point = joints_of(Gesture::point), carry = joints_of(Gesture::carry);
  const JointPoses none = joints_of(Gesture::none);
  EXPECT_LT((palm(phone, -1) - phone[Joint::head].translation).norm(), 0.22);
  EXPECT_LT(palm(phone, 1).z(), 1.0);
  EXPECT_GT(palm(wave, -1).z(), wave[Joint::right_upper_arm].translation.z() + 0.15);
  EXPECT_GT(palm(point, -1).x(), 0.45);
  EXPECT_LT(palm(none, -1).z(), none[Joint::pelvis].translation.z());
  for (const int side : {1, -1}) {
    EXPECT_GT(palm(carry, side).x(), 0.25);
    EXPECT_NEAR(std::abs(palm(carry, side).y()), 0.17, 0.05);
    EXPECT_NEAR(palm(carry, side).z(), 1.05, 0.2);
  }
}

/// Positions of joints and of points beside them: their rotations, too.
std::vector<Vector3d> markers(const FigureMotion& motion, double time) {
  std::vector<Vector3d> points;
  for (const Se3& joint : motion.joints(time)) {
    points.push_back(joint.translation);
    points.push_back(joint * Vector3d(0.1, 0.1, 0.1));
  }
  return points;
}

TEST(FigureMotion, NothingJumps) {
  for (const std::uint64_t seed : {1, 2}) {
    FigureOptions options = busy_day(seed);
    options.repeat = true;
    const FigureMotion motion = motion_of(options);
    constexpr double step = 1e-3;
    std::vector<Vector3d> before = markers(motion, 0.0), last = markers(motion, step);
    double fastest = 0.0, hardest = 0.0, when = 0.0;
    std::size_t worst = 0;
    for (double time = 2.0 * step; time < 90.0; time += step) {
      std::vector<Vector3d> now = markers(motion, time);
      for (std::size_t i = 0; i < now.size(); ++i) {
        fastest = std::max(fastest, (now[i] - last[i]).norm() / step);
        const double change = (now[i] - 2.0 * last[i] + before[i]).norm() / step;
        if (change > hardest) {
          hardest = change;
          when = time;
          worst = i / 2;
        }
      }
      before = std::move(last);
      last = std::move(now);
    }
    EXPECT_LT(fastest, 8.0);
    EXPECT_LT(hardest, 0.6) << "metres per second from one millisecond to the next, at " << when
                            << " s, joint " << worst;
  }
}

}  // namespace
}  // namespace dkp_slam

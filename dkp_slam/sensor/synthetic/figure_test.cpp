#include "dkp_slam/sensor/synthetic/figure.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/sensor/synthetic/figure_motion.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Kind = Activity::Kind;

/// Everything a figure can do, about a minute long.
FigureOptions busy_day(std::uint64_t seed) {
  FigureOptions options;
  options.seed = seed;
  options.start = {-1.0, -1.0};
  options.heading = 2.5;
  options.activities = {{Kind::walk_to, {1.5, 0.0}, 0.0, 0.0, Gesture::none},
                        {Kind::walk_to, {1.5, 1.5}, 0.0, 0.0, Gesture::carry},
                        {Kind::walk_to, {-1.0, 1.5}, 0.0, 0.0, Gesture::carry},
                        {Kind::stand, {0, 0}, 3.0, 3.0, Gesture::wave},
                        {Kind::sit, {-1.0, 0.0}, -1.5, 4.0, Gesture::type},
                        {Kind::sit, {-1.0, 0.0}, -1.5, 2.0, Gesture::phone},
                        {Kind::stand, {0, 0}, 1.0, 2.0, Gesture::talk},
                        {Kind::walk_to, {0.2, 0.1}, 0.0, 0.0, Gesture::phone},
                        {Kind::stand, {0, 0}, -2.5, 2.0, Gesture::point},
                        {Kind::sit, {-1.0, 0.0}, -1.5, 3.0, Gesture::none}};
  return options;
}

FigureOptions doing(Gesture gesture) {
  FigureOptions options;
  options.activities = {{Kind::stand, {0, 0}, 0.0, 10.0, gesture}};
  return options;
}

FigureOptions seated(std::uint64_t seed) {
  FigureOptions options;
  options.seed = seed;
  options.start = {1.0, 2.0};
  options.heading = 0.7;
  options.starts_seated = true;
  options.activities = {{Kind::sit, {1.0, 2.0}, 0.7, 5.0, Gesture::none}};
  return options;
}

FigureOptions walking(double metres) {
  FigureOptions options;
  options.activities = {{Kind::walk_to, {metres, 0.0}, 0.0, 0.0, Gesture::none}};
  return options;
}

FigureMotion motion_of(const FigureOptions& options) {
  return FigureMotion(options, random_look(options.seed));
}

void for_each_vertex(const Figure& figure, double time,
                     const std::function<void(const Vector3d&, const Vector3d&)>& visit) {
  for (const MeshPose& pose : figure.at(time)) {
    for (std::size_t i = 0; i < pose.vertices.size(); ++i) {
      visit(pose.vertices[i].cast<double>(), pose.normals[i].cast<double>());
    }
  }
}

Vector3d palm(const JointPoses& joints, int side) {
  return joints[of_side(Joint::left_hand, side)] * Vector3d(0.0, 0.0, -0.075);
}

TEST(Figure, MeshesAreWhole) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    FigureOptions options;
    options.seed = seed;
    const Figure figure(options);
    EXPECT_EQ(figure.class_name(), "person");
    std::size_t triangles = 0;
    for (const Mesh& mesh : figure.meshes()) {
      const auto count = static_cast<int>(mesh.rest.vertices.size());
      ASSERT_EQ(mesh.rest.normals.size(), mesh.rest.vertices.size());
      ASSERT_EQ(mesh.uv.size(), mesh.rest.vertices.size());
      ASSERT_TRUE(mesh.texture);
      for (const Eigen::Vector2f& uv : mesh.uv) {
        ASSERT_TRUE(uv.minCoeff() >= 0.0F && uv.maxCoeff() <= 1.0F);
      }
      for (const Eigen::Vector3i& t : mesh.triangles) {
        ASSERT_TRUE(t.minCoeff() >= 0 && t.maxCoeff() < count);
      }
      triangles += mesh.triangles.size();
    }
    EXPECT_GT(triangles, 3000u);
    EXPECT_LT(triangles, 12000u);
    double lowest = 9.0, highest = 0.0;
    for_each_vertex(figure, 0.0, [&](const Vector3d& v, const Vector3d& n) {
      ASSERT_NEAR(n.norm(), 1.0, 1e-5);
      lowest = std::min(lowest, v.z());
      highest = std::max(highest, v.z());
    });
    EXPECT_NEAR(lowest, 0.0, 0.01);
    EXPECT_GT(highest, 1.50);
    EXPECT_LT(highest, 2.0);
  }
}

TEST(Figure, NormalsPointOutwards) {
  const Figure figure(FigureOptions{});
  std::size_t outside = 0, all = 0;
  for (const Mesh& mesh : figure.meshes()) {
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto i = t.cast<std::size_t>().eval();
      const std::vector<Eigen::Vector3f>& v = mesh.rest.vertices;
      const Eigen::Vector3f face = (v[i.y()] - v[i.x()]).cross(v[i.z()] - v[i.x()]);
      if (face.norm() < 1e-9F) continue;
      ++all;
      for (const std::size_t k : i) outside += face.dot(mesh.rest.normals[k]) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(static_cast<double>(outside), 0.99 * 3.0 * static_cast<double>(all));
  // And the head's point away from its middle.
  double sum = 0.0;
  const Mesh& head = figure.meshes()[6];
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& v : head.rest.vertices) middle += v;
  middle /= static_cast<float>(head.rest.vertices.size());
  for (std::size_t i = 0; i < head.rest.vertices.size(); ++i) {
    sum += (head.rest.vertices[i] - middle).normalized().dot(head.rest.normals[i]);
  }
  EXPECT_GT(sum / static_cast<double>(head.rest.vertices.size()), 0.5);
}

TEST(Figure, SameSeedSameBytes) {
  const Figure a(busy_day(3)), b(busy_day(3)), c(busy_day(4));
  for (const double time : {0.0, 3.3, 20.0}) {
    const auto pa = a.at(time), pb = b.at(time);
    for (std::size_t m = 0; m < pa.size(); ++m) {
      EXPECT_EQ(pa[m].vertices, pb[m].vertices);
      EXPECT_EQ(pa[m].normals, pb[m].normals);
    }
  }
  bool differ = false;
  for (std::size_t m = 0; m < a.meshes().size(); ++m) {
    for (const double at : {0.2, 0.4, 0.7}) {
      const Vector2d uv(at, at), nothing(0.0, 0.0);
      const cv::Vec3f one = a.meshes()[m].texture->sample(uv, nothing, nothing);
      EXPECT_EQ(one, b.meshes()[m].texture->sample(uv, nothing, nothing));
      differ |= one != c.meshes()[m].texture->sample(uv, nothing, nothing);
    }
  }
  EXPECT_TRUE(differ);
  EXPECT_NE(a.meshes()[0].rest.vertices, c.meshes()[0].rest.vertices);
}

TEST(Figure, BonesKeepTheirLengths) {
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

TEST(Figure, FeetStayOnTheFloorAndDoNotSlide) {
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
  const Figure walker(busy_day(2));
  for (double time = 0.0; time < 60.0; time += 0.13) {
    double lowest = 1.0;
    for_each_vertex(walker, time,
                    [&](const Vector3d& v, const Vector3d&) { lowest = std::min(lowest, v.z()); });
    EXPECT_GT(lowest, -0.02) << "at " << time;
    EXPECT_LT(lowest, 0.03) << "floats at " << time;
  }
}

TEST(Figure, LegsReachTheirFeetWhileWalking) {
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

TEST(Figure, ArmsSwingAgainstTheLegs) {
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

TEST(Figure, WalksWhereAndAsFastAsTold) {
  FigureOptions options = walking(6.0);
  options.walking_speed = 1.3;
  const Figure figure(options);
  EXPECT_LT((figure.root(6.0 / 1.3 + 1.0).translation - Vector3d(6.0, 0.0, 0.0)).norm(), 0.01);
  EXPECT_GT((figure.root(6.0 / 1.3 - 0.5).translation - Vector3d(6.0, 0.0, 0.0)).norm(), 0.5);
  const double speed = (figure.root(3.0).translation - figure.root(2.0).translation).norm();
  EXPECT_NEAR(speed, 1.3, 1e-6);
  EXPECT_LT((figure.root(1e6).translation - Vector3d(6.0, 0.0, 0.0)).norm(), 1e-9);
}

TEST(Figure, TurnsBeforeItWalksBack) {
  FigureOptions options;
  options.activities = {{Kind::walk_to, {-3.0, 0.0}, 0.0, 0.0, Gesture::none}};
  const Figure figure(options);
  for (double time = 0.0; time < 5.0; time += 0.05) {
    const Vector3d velocity =
        (figure.root(time + 0.01).translation - figure.root(time).translation) / 0.01;
    const Vector3d ahead = figure.root(time).rotation * Vector3d::UnitX();
    if (velocity.norm() > 0.2) {
      EXPECT_GT(ahead.dot(velocity.normalized()), 0.2) << time;
    }
  }
  EXPECT_NEAR((figure.root(9.0).rotation * Vector3d::UnitX()).x(), -1.0, 1e-6);
}

TEST(Figure, SitsOnTheSeat) {
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

TEST(Figure, SitsDownAndGetsUp) {
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

TEST(Figure, StandsUpright) {
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

TEST(Figure, HandsFollowTheGestures) {
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

TEST(Figure, CarriesAlong) {
  FigureOptions options = walking(5.0);
  options.activities[0].gesture = Gesture::carry;
  const Figure figure(options);
  for (double time = 0.0; time < 7.0; time += 0.05) {
    const Se3 hands = figure.root(time).inverse() * figure.hands(time);
    EXPECT_GT(hands.translation.x(), 0.25);
    EXPECT_LT(hands.translation.x(), 0.55);
    EXPECT_LT(std::abs(hands.translation.y()), 0.06);
    EXPECT_NEAR(hands.translation.z(), 1.0, 0.2);
    EXPECT_LT(hands.angle(), 1e-9);
  }
}

TEST(Figure, RepeatsItsActivities) {
  FigureOptions options;
  options.repeat = true;
  options.activities = {{Kind::walk_to, {2.0, 0.0}, 0.0, 0.0, Gesture::none},
                        {Kind::walk_to, {0.0, 0.0}, 0.0, 0.0, Gesture::none}};
  const Figure figure(options);
  int ends = 0;
  bool far = false;
  for (double time = 100.0; time < 200.0; time += 0.05) {
    const double x = figure.root(time).translation.x();
    EXPECT_GT(x, -0.01);
    EXPECT_LT(x, 2.01);
    if (x > 1.5 && !far) {
      far = true;
      ++ends;
    }
    if (x < 0.5) far = false;
  }
  EXPECT_GE(ends, 12);
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

TEST(Figure, NothingJumps) {
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

TEST(Figure, NoTriangleIsStretched) {
  const Figure figure(busy_day(5));
  double worst = 0.0;
  for (double time = 0.0; time < 60.0; time += 0.5) {
    const std::vector<MeshPose> poses = figure.at(time);
    for (std::size_t m = 0; m < poses.size(); ++m) {
      const Mesh& mesh = figure.meshes()[m];
      for (const Eigen::Vector3i& t : mesh.triangles) {
        const auto i = t.cast<std::size_t>().eval();
        const auto length = [&](const MeshPose& p, std::size_t a, std::size_t b) {
          return static_cast<double>((p.vertices[a] - p.vertices[b]).norm());
        };
        for (const auto& [a, b] : {std::pair(i.x(), i.y()), {i.y(), i.z()}, {i.z(), i.x()}}) {
          worst = std::max(worst, length(poses[m], a, b) - length(mesh.rest, a, b));
        }
      }
    }
  }
  EXPECT_LT(worst, 0.06);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/synth/figure/figure.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/synth/figure/figure_test_scripts.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Kind = Activity::Kind;

void for_each_vertex(const Figure& figure, double time,
                     const std::function<void(const Vector3d&, const Vector3d&)>& visit) {
  for (const MeshPose& pose : figure.at(time)) {
    for (std::size_t i = 0; i < pose.vertices.size(); ++i) {
      visit(pose.vertices[i].cast<double>(), pose.normals[i].cast<double>());
    }
  }
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

TEST(Figure, StaysOnTheFloor) {
  const Figure walker(busy_day(2));
  for (double time = 0.0; time < 60.0; time += 0.13) {
    double lowest = 1.0;
    for_each_vertex(walker, time,
                    [&](const Vector3d& v, const Vector3d&) { lowest = std::min(lowest, v.z()); });
    EXPECT_GT(lowest, -0.02) << "at " << time;
    EXPECT_LT(lowest, 0.03) << "floats at " << time;
  }
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

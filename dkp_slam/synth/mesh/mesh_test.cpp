#include "dkp_slam/synth/mesh/mesh.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// By the divergence theorem: positive only if the triangles are seen counter-clockwise.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int i) { return mesh.rest.vertices[std::size_t(i)].cast<double>().eval(); };
    sum += at(t.x()).dot(at(t.y()).cross(at(t.z()))) / 6.0;
  }
  return sum;
}

void expect_normals_outside(const Mesh& mesh) {
  ASSERT_EQ(mesh.rest.normals.size(), mesh.rest.vertices.size());
  ASSERT_EQ(mesh.uv.size(), mesh.rest.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int i) { return mesh.rest.vertices[std::size_t(i)]; };
    const Vector3f face = (at(t.y()) - at(t.x())).cross(at(t.z()) - at(t.x()));
    if (face.norm() < 1e-7F) continue;  // at a pole
    for (const int i : t) EXPECT_GT(face.dot(mesh.rest.normals[std::size_t(i)]), 0.0F);
  }
}

TEST(SyntheticMesh, Panel) {
  const Mesh mesh = panel_mesh({1, 2, 3}, {2, 0, 0}, {0, 3, 0}, nullptr);
  expect_normals_outside(mesh);
  EXPECT_EQ(mesh.rest.vertices[2], Vector3f(3, 5, 3));
  EXPECT_EQ(mesh.uv[2], Eigen::Vector2f(1, 1));
  EXPECT_EQ(mesh.rest.normals[0], Vector3f(0, 0, 1));
}

TEST(SyntheticMesh, Box) {
  const Mesh mesh = box_mesh({1, 2, 3}, nullptr);
  expect_normals_outside(mesh);
  EXPECT_NEAR(volume(mesh), 6.0, 1e-6);
  // Upright: the top row of the texture on the upper edge of every side face.
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(mesh.uv[i].y() == 0.0F, mesh.rest.vertices[i].z() > 0.0F);
  }
}

TEST(SyntheticMesh, BallAndCylinder) {
  const Mesh ball = ellipsoid_mesh({0.5, 1.0, 2.0}, 64, nullptr);
  expect_normals_outside(ball);
  EXPECT_NEAR(volume(ball), 4.0 / 3.0 * std::numbers::pi, 0.03);
  const Mesh cylinder = lathe_mesh({{0, 1}, {0.5, 1}, {0.5, -1}, {0, -1}}, 64, nullptr);
  EXPECT_NEAR(volume(cylinder), 0.5 * std::numbers::pi, 0.01);
  EXPECT_NEAR((cylinder.rest.vertices[65 + 32] - Vector3f(0.5F, 0, 1)).norm(), 0.0, 1e-6);
}

TEST(SyntheticMesh, Moves) {
  const Se3 pose(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())),
                 {1, 0, 0});
  const Mesh mesh = pose * panel_mesh({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, nullptr);
  EXPECT_NEAR((mesh.rest.vertices[0] - Vector3f(1, 1, 0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((mesh.rest.normals[0] - Vector3f(0, 1, 0)).norm(), 0.0, 1e-6);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/dense/level_frame.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

/// A floor at z = 0, a table top at 0.7 m, a ceiling and a wall, in a frame with z up. The normals
/// of what faces up lean by 2 degrees, as those of surfaces that are seen at an angle do.
SurfaceMesh room_mesh() {
  SurfaceMesh mesh;
  const auto add = [&](const Vector3d& at, const Vector3d& normal) {
    mesh.vertices.emplace_back(at.cast<float>());
    mesh.normals.emplace_back(normal.cast<float>());
    mesh.colours.push_back({});
  };
  const Vector3d leaning = Vector3d(0.035, 0.0, 1.0).normalized();
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 60; ++k) {
      const double x = 0.05 * i, y = 0.05 * k;
      add({x, y, 0.0}, leaning);
      if (i < 30 && k < 30) add({x, y, 0.7}, leaning);
      add({x, y, 2.5}, -Vector3d::UnitZ());
      add({3.0, y, 0.05 * i}, -Vector3d::UnitX());
    }
  }
  return mesh;
}

SurfaceMesh moved(const SurfaceMesh& mesh, const Se3& to) {
  SurfaceMesh result = mesh;
  for (auto& v : result.vertices) v = (to * Vector3d(v.cast<double>())).cast<float>();
  for (auto& n : result.normals) n = (to.rotation * n.cast<double>()).cast<float>();
  return result;
}

TEST(LevelFrame, FindsTheFloorUnderATiltedCamera) {
  // Camera at 1.2 m, along x, tilted 25 degrees down and rolled a little.
  Eigen::Matrix3d axes;  // of an upright camera: x right, y down, z ahead
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond tilt = Eigen::AngleAxisd(-25.0 * M_PI / 180.0, Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.1, Vector3d::UnitZ());
  const Se3 room_from_camera(Eigen::Quaterniond(axes) * tilt, {0.5, 1.5, 1.2});
  const LevelFrame level =
      find_level(moved(room_mesh(), room_from_camera.inverse()), Trajectory{{1.0, {}}});
  EXPECT_TRUE(level.found);
  const Vector3d foot =
      level.level_from_world * (room_from_camera.inverse() * Vector3d(0.5, 1.5, 0));
  EXPECT_LT(foot.norm(), 0.001);
  const Vector3d up =
      level.level_from_world.rotation * (room_from_camera.rotation.conjugate() * Vector3d::UnitZ());
  EXPECT_LT((up - Vector3d::UnitZ()).norm(), 0.001);
  const Vector3d camera = level.level_from_world * Vector3d::Zero();
  EXPECT_NEAR(camera.z(), 1.2, 0.001);
  // x is where the camera looked.
  const Vector3d ahead = level.level_from_world.rotation * Vector3d::UnitZ();
  EXPECT_GT(ahead.x(), 0.8);
  EXPECT_NEAR(ahead.y(), 0.0, 1e-6);
}

TEST(LevelFrame, WithoutAFloorUpIsTheCameras) {
  SurfaceMesh wall;
  wall.vertices = {{0, 0.5F, 2}, {1, -0.5F, 2}};
  wall.normals.assign(2, {0, 0, -1});
  const LevelFrame level = find_level(wall, Trajectory{{1.0, {}}});
  EXPECT_FALSE(level.found);
  EXPECT_NEAR((level.level_from_world * Vector3d(0, 0.5, 2)).z(), 0.0, 1e-6);
  EXPECT_NEAR((level.level_from_world * Vector3d(0, -0.5, 2)).z(), 1.0, 1e-6);
  EXPECT_THROW(find_level(wall, {}), Error);
  EXPECT_THROW(find_level({}, Trajectory{{1.0, {}}}), Error);
}

}  // namespace
}  // namespace dkp_slam

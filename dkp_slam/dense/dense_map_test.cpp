#include "dkp_slam/dense/dense_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::ball;
using testing::both;
using testing::box;
using testing::Scene;
using testing::seen;
using testing::small_camera;
using testing::swaying;
using testing::wall;

const Vector3d centre(0.1, 0.0, 1.4);
constexpr double radius = 0.35;
const AlignedBox3d guest(Vector3d(-0.2, -0.2, 1.0), Vector3d(0.2, 0.2, 1.3));

/// Fuses what is seen of a scene that may change from view to view.
SurfaceMesh fused(const DepthViewer& viewer, int views, const std::function<Scene(int)>& scene,
                  const DenseMapOptions& options = {}) {
  DenseMap map(viewer.camera(), options);
  std::vector<StaticView> all;
  for (int i = 0; i < views; ++i) {
    all.push_back(viewer.view(seen(viewer.camera(), scene(i), swaying(i)), swaying(i)));
  }
  for (const StaticView& view : all) map.reserve(view);
  for (const StaticView& view : all) map.fuse(view);
  return extract_surface(map);
}

SurfaceMesh fused(int views, const std::function<Scene(int)>& scene) {
  return fused(DepthViewer(small_camera()), views, scene);
}

/// Vertices in a box that is a little larger than this one.
long vertices_in(const SurfaceMesh& mesh, const AlignedBox3d& where) {
  const AlignedBox3d grown(where.min() - Vector3d::Constant(0.05),
                           where.max() + Vector3d::Constant(0.05));
  return std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                       [&](const Eigen::Vector3f& v) { return grown.contains(v.cast<double>()); });
}

TEST(DenseMap, APlaneAndABallLieWhereTheyAre) {
  const SurfaceMesh mesh = fused(12, [](int) { return both(wall(2.0), ball(centre, radius)); });
  double sum = 0.0, most = 0.0;
  long on_ball = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d v = mesh.vertices[i].cast<double>();
    const double to_wall = std::abs(v.z() - 2.0), to_ball = std::abs((v - centre).norm() - radius);
    const double error = std::min(to_wall, to_ball);
    sum += error;
    most = std::max(most, error);
    on_ball += to_ball < to_wall;
    // Out of the surface, to where the camera was.
    const Vector3d outwards = to_ball < to_wall ? Vector3d(v - centre) : Vector3d(0.0, 0.0, -1.0);
    EXPECT_GT(mesh.normals[i].cast<double>().dot(outwards.normalized()), 0.6);
    EXPECT_NEAR(mesh.colours[i][0], 90, 1);
    EXPECT_NEAR(mesh.colours[i][2], 30, 1);
  }
  EXPECT_LT(sum / double(mesh.vertices.size()), 0.0015);
  EXPECT_LT(most, 0.012);
  // A quarter of the ball's surface, and a vertex for every 4 square centimetres of it.
  EXPECT_GT(double(on_ball), 4.0 * M_PI * radius * radius / 4.0 / (0.02 * 0.02));
  for (const auto& t : mesh.triangles) {
    const auto at = [&](int k) { return mesh.vertices[std::size_t(t[std::size_t(k)])]; };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    EXPECT_GT(normal.dot(mesh.normals[std::size_t(t[0])]), -1e-6F);
  }
}

TEST(DenseMap, WhatLeavesIsCarvedOut) {
  const auto until = [](int last) {
    return [last](int i) { return i < last ? both(wall(2.0), box(guest)) : wall(2.0); };
  };
  EXPECT_GT(vertices_in(fused(20, until(20)), guest), 300);
  const SurfaceMesh after = fused(50, until(20));
  EXPECT_EQ(vertices_in(after, guest), 0);
  EXPECT_GT(after.vertices.size(), 5000U) << "the wall behind it";
}

TEST(DenseMap, WhatComesIsThereAtTheEnd) {
  const SurfaceMesh mesh =
      fused(60, [](int i) { return i < 30 ? wall(2.0) : both(wall(2.0), box(guest)); });
  EXPECT_GT(vertices_in(mesh, guest), 300);
}

TEST(DenseMap, WhatAFewViewsSawInFreeSpaceIsNotThere) {
  const SurfaceMesh mesh =
      fused(40, [](int i) { return i >= 36 ? both(wall(2.0), box(guest)) : wall(2.0); });
  EXPECT_EQ(vertices_in(mesh, guest), 0);
}

TEST(DenseMap, WhatLiesInMasksNeverEnters) {
  const DepthViewer viewer(small_camera());
  DenseMap map(viewer.camera());
  for (int i = 0; i < 12; ++i) {
    RgbdFrame frame = seen(viewer.camera(), both(wall(2.0), box(guest)), swaying(i));
    frame.mask = frame.depth < 1.6F;
    const StaticView view = viewer.view(frame, swaying(i));
    map.reserve(view);
    map.fuse(view);
  }
  const SurfaceMesh mesh = extract_surface(map);
  EXPECT_EQ(vertices_in(mesh, guest), 0);
  EXPECT_GT(mesh.vertices.size(), 3000U);
}

TEST(DenseMap, WhoIsMaskedInSomeViewsOnlyNeverEntersEither) {
  const DepthViewer viewer(small_camera());
  const auto guests_in = [&](int masked_every) {
    DenseMap map(viewer.camera());
    for (int i = 0; i < 24; ++i) {
      RgbdFrame frame = seen(viewer.camera(), both(wall(2.0), box(guest)), swaying(i));
      frame.mask = frame.depth < (i % masked_every == 0 ? 1.6F : 0.0F);
      const StaticView view = viewer.view(frame, swaying(i));
      map.reserve(view);
      map.fuse(view);
    }
    const SurfaceMesh mesh = extract_surface(map);
    EXPECT_GT(mesh.vertices.size(), 3000U);
    return vertices_in(mesh, guest);
  };
  EXPECT_EQ(guests_in(3), 0);
  EXPECT_GT(guests_in(12), 300) << "a mask that is wrong now and then takes nothing away";
}

TEST(DenseMap, TheRowsOfARollingShutterSeeFromTheirOwnPlaces) {
  Camera camera = small_camera();
  camera.readout = 0.03;
  Vector6d velocity;
  velocity << 0.0, 0.0, 0.0, 0.0, 1.0,
      0.0;  // radians per second: 2.1 cm from side to side at 1.4 m
  const DepthViewer viewer(camera);
  const auto error_with = [&](const Vector6d& told) {
    DenseMap map(camera);
    for (int i = 0; i < 4; ++i) {
      const RgbdFrame frame =
          testing::seen_by_rows(camera, both(wall(2.0), ball(centre, radius)), [&](int row) {
            return Se3::exp(velocity * (double(row) / camera.height - 0.5) * camera.readout);
          });
      const StaticView view = viewer.view(frame, {}, told);
      map.reserve(view);
      map.fuse(view);
    }
    const SurfaceMesh mesh = extract_surface(map);
    double sum = 0.0;
    for (const auto& v : mesh.vertices) {
      const Vector3d p = v.cast<double>();
      sum += std::min(std::abs(p.z() - 2.0), std::abs((p - centre).norm() - radius));
    }
    return sum / double(mesh.vertices.size());
  };
  const double told = error_with(velocity), not_told = error_with(Vector6d::Zero());
  EXPECT_LT(told, 0.002);
  EXPECT_GT(not_told, 2.0 * told);
}

TEST(DenseMap, TheLensIsTakenOut) {
  Camera camera = small_camera();
  camera.distortion.k1 = 0.25;
  camera.distortion.k2 = -0.4;
  const SurfaceMesh mesh = fused(DepthViewer(camera), 6, [](int) {
    return both(ball({0.6, 0.35, 1.6}, 0.2), wall(2.5));
  });
  double sum = 0.0;
  long on_ball = 0;
  for (const auto& v : mesh.vertices) {
    const double error = std::abs((v.cast<double>() - Vector3d(0.6, 0.35, 1.6)).norm() - 0.2);
    if (error > 0.05) continue;
    sum += error;
    ++on_ball;
  }
  EXPECT_GT(on_ball, 100);
  EXPECT_LT(sum / double(on_ball), 0.004);
}

TEST(DenseMap, MemoryHasABoundAndWhatThereIsStays) {
  DenseMapOptions options;
  options.memory = 1.0;
  const DepthViewer viewer(small_camera());
  DenseMap map(viewer.camera(), options);
  const StaticView view = viewer.view(seen(viewer.camera(), wall(2.0)), {});
  map.reserve(view);
  EXPECT_TRUE(map.full());
  EXPECT_LE(map.megabytes(), 1.0);
  for (int i = 0; i < 4; ++i) map.fuse(view);
  EXPECT_GT(extract_surface(map).vertices.size(), 100U);
}

TEST(DenseMap, TheSameViewsGiveTheSameOnAnyNumberOfThreads) {
  const auto scene = [](int) { return both(wall(2.0), ball(centre, radius)); };
  cv::setNumThreads(1);
  const SurfaceMesh one = fused(5, scene);
  cv::setNumThreads(4);
  const SurfaceMesh four = fused(5, scene);
  cv::setNumThreads(-1);
  ASSERT_EQ(one.vertices.size(), four.vertices.size());
  EXPECT_EQ(one.triangles, four.triangles);
  EXPECT_EQ(one.colours, four.colours);
  for (std::size_t i = 0; i < one.vertices.size(); ++i)
    EXPECT_EQ(one.vertices[i], four.vertices[i]);
}

TEST(DenseMap, RefusesWhatMakesNoSense) {
  const Camera camera = small_camera();
  for (const double voxel : {0.0, 0.004, 0.3, double(NAN)}) {
    DenseMapOptions options;
    options.voxel = voxel;
    EXPECT_THROW(DenseMap(camera, options), Error) << voxel;
  }
  DepthViewOptions range;
  range.max_range = 0.1;
  EXPECT_THROW(DepthViewer(camera, range), Error);
  RgbdFrame frame = seen(camera, wall(2.0));
  frame.depth = frame.depth(cv::Rect(0, 0, 80, 60));
  EXPECT_THROW(DepthViewer(camera).view(frame, {}), Error);
}

}  // namespace
}  // namespace dkp_slam

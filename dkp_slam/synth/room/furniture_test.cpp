#include "dkp_slam/synth/room/furniture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/noise/sensor_effects.h"
#include "dkp_slam/synth/render/renderer.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct Bounds {
  Vector3f low = Vector3f::Constant(1e9F), high = Vector3f::Constant(-1e9F);
};

Bounds bounds_of(const std::vector<Mesh>& meshes) {
  Bounds b;
  for (const Mesh& mesh : meshes) {
    for (const Vector3f& v : mesh.rest.vertices) {
      b.low = b.low.cwiseMin(v);
      b.high = b.high.cwiseMax(v);
    }
  }
  return b;
}

void expect_sound(const std::vector<Mesh>& meshes, const std::string& name) {
  ASSERT_FALSE(meshes.empty()) << name;
  for (const Mesh& mesh : meshes) {
    ASSERT_TRUE(mesh.texture) << name;
    const auto count = static_cast<int>(mesh.rest.vertices.size());
    ASSERT_EQ(mesh.rest.normals.size(), mesh.rest.vertices.size()) << name;
    ASSERT_EQ(mesh.uv.size(), mesh.rest.vertices.size()) << name;
    for (const Vector3f& n : mesh.rest.normals) ASSERT_NEAR(n.norm(), 1.0F, 1e-3F) << name;
    for (const Eigen::Vector2f& uv : mesh.uv) {
      ASSERT_TRUE((uv.array() > -1e-3F).all() && (uv.array() < 1.001F).all()) << name;
    }
    for (const Eigen::Vector3i& t : mesh.triangles) {
      ASSERT_TRUE((t.array() >= 0).all() && (t.array() < count).all()) << name;
      const auto at = [&](const auto& of, int i) { return of[static_cast<std::size_t>(t[i])]; };
      const Vector3f outside = (at(mesh.rest.vertices, 1) - at(mesh.rest.vertices, 0))
                                   .cross(at(mesh.rest.vertices, 2) - at(mesh.rest.vertices, 0));
      const Vector3f normal =
          at(mesh.rest.normals, 0) + at(mesh.rest.normals, 1) + at(mesh.rest.normals, 2);
      ASSERT_GE(outside.dot(normal), -1e-9F) << name << ": counter-clockwise seen from outside";
    }
  }
}

TEST(Furniture, PiecesAreSoundAndStandOnTheFloorWithinTheirMeasures) {
  cv::RNG rng(4);
  struct Piece {
    std::string name;
    std::vector<Mesh> meshes;
    Vector3f most;  ///< width, depth, height
  };
  const Piece pieces[] = {{"desk", desk(rng, 1.6, 0.8), {1.6F, 0.8F, 0.75F}},
                          {"chair", office_chair(rng), {0.75F, 0.75F, 1.1F}},
                          {"cabinet", drawer_cabinet(rng), {0.43F, 0.56F, 0.63F}},
                          {"shelf", book_shelf(rng, 1.0, 1.9), {1.01F, 0.31F, 1.91F}},
                          {"monitor", monitor(rng), {0.61F, 0.3F, 0.6F}},
                          {"box", cardboard_box(rng, {0.4, 0.3, 0.2}), {0.401F, 0.301F, 0.201F}},
                          {"plant", potted_plant(rng), {1.0F, 1.0F, 1.3F}},
                          {"sofa", sofa(rng), {2.0F, 0.9F, 0.95F}}};
  for (const Piece& piece : pieces) {
    expect_sound(piece.meshes, piece.name);
    const Bounds b = bounds_of(piece.meshes);
    EXPECT_NEAR(b.low.z(), 0.0F, 0.003F) << piece.name;
    const Vector3f size = b.high - b.low;
    for (int a = 0; a < 3; ++a) EXPECT_LE(size[a], piece.most[a]) << piece.name << " " << a;
    EXPECT_LT((0.5F * (b.high + b.low)).head<2>().norm(), 0.12F) << piece.name;
  }
}

TEST(Furniture, DrawersFitIntoTheirCabinetOneAboveTheOther) {
  cv::RNG rng(4);
  const Bounds cabinet = bounds_of(drawer_cabinet(rng));
  float below = 0.0F;
  for (int i = 0; i < 3; ++i) {
    const std::vector<Mesh> drawer = cabinet_drawer(rng, i);
    expect_sound(drawer, "drawer");
    const Bounds b = bounds_of(drawer);
    EXPECT_GT(b.low.x(), cabinet.low.x() + 0.02F);
    EXPECT_LT(b.high.x(), cabinet.high.x() - 0.02F);
    EXPECT_LT(b.high.y(), cabinet.high.y() - 0.02F);
    EXPECT_GT(b.low.z(), below);
    EXPECT_LT(b.high.z(), cabinet.high.z());
    below = b.high.z();
  }
}

Se3 looking(const Vector3d& from, const Vector3d& to) {
  const Vector3d z = (to - from).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return {Eigen::Quaterniond(axes), from};
}

Camera wide_camera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.84 * width;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

const Renderer& in_office() {
  static const Renderer renderer = [] {
    cv::RNG rng(1);
    return Renderer(office(rng), {});
  }();
  return renderer;
}

const Renderer& in_flat() {
  static const Renderer renderer = [] {
    cv::RNG rng(1);
    return Renderer(flat(rng), {});
  }();
  return renderer;
}

/// Corners that ORB's detector finds, and in how many of 8 x 6 parts of the view at least three.
std::pair<std::size_t, int> corners(const Renderer& renderer, const Vector3d& from,
                                    const Vector3d& to) {
  const Se3 pose = looking(from, to);
  const Rendering seen =
      renderer.render(wide_camera(640, 480), [&](double) { return pose; }, 0.0, {});
  ColourSensor sensor({}, 1);
  cv::Mat grey;
  cv::cvtColor(sensor.expose(seen.radiance, 0.0), grey, cv::COLOR_BGR2GRAY);
  std::vector<cv::KeyPoint> points;
  cv::FAST(grey, points, 12);
  std::vector<int> cells(48, 0);
  for (const cv::KeyPoint& p : points) {
    ++cells[static_cast<std::size_t>(static_cast<int>(p.pt.y / 80) * 8 +
                                     static_cast<int>(p.pt.x / 80))];
  }
  return {points.size(), static_cast<int>(std::count_if(cells.begin(), cells.end(),
                                                        [](int n) { return n >= 3; }))};
}

TEST(Office, IsClosedAndSound) {
  cv::RNG rng(1);
  const Place place = office(rng);
  expect_sound(place.meshes, "office");
  EXPECT_EQ(place.lamps.size(), 4U);
  for (const Vector3d& direction :
       {Vector3d(1, 0.1, 0), Vector3d(-1, 0.1, 0), Vector3d(0, 1, 0.01), Vector3d(0, -1, 0.01),
        Vector3d(0.01, 0, 1), Vector3d(0, 0.01, -1)}) {
    const Se3 pose = looking({0, 0, 1.5}, Vector3d(0, 0, 1.5) + direction);
    const Rendering seen =
        in_office().render(wide_camera(160, 120), [&](double) { return pose; }, 0.0, {});
    EXPECT_EQ(cv::countNonZero(seen.depth > 0.2F), 160 * 120) << direction.transpose();
  }
}

TEST(Office, CornersEverywhere) {
  for (const auto& [from, to] : {std::pair(Vector3d(0, 0, 1.4), Vector3d(0, 2, 1.0)),
                                 {Vector3d(0, 0.3, 1.4), Vector3d(2, 1.5, 1.2)},
                                 {Vector3d(0, 0, 1.4), Vector3d(-2.5, 1.2, 1.0)},
                                 {Vector3d(0, 0.5, 1.4), Vector3d(0.5, -2.4, 1.0)},
                                 {Vector3d(-2, -2, 1.8), Vector3d(1.5, 3, 1.0)}}) {
    const auto [count, cells] = corners(in_office(), from, to);
    EXPECT_GT(count, 800U) << from.transpose();
    EXPECT_GE(cells, 30) << from.transpose();
  }
}

TEST(Furniture, SeedsGiveTheirOwnPrints) {
  const auto print = [](std::uint64_t seed) {
    cv::RNG rng(seed);
    cv::Vec3f sum(0, 0, 0);
    for (const Mesh& mesh : book_shelf(rng)) sum += mesh.texture->mean();
    return sum;
  };
  EXPECT_EQ(print(1), print(1));
  EXPECT_NE(print(1), print(2));
}

TEST(Flat, LoopIsClosedAndAbout25MetresLong) {
  const auto loop = flat_loop();
  double length = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double step = (loop[(i + 1) % loop.size()] - loop[i]).norm();
    length += step;
    longest = std::max(longest, step);
  }
  EXPECT_GT(length, 22.0);
  EXPECT_LT(length, 28.0);
  EXPECT_LT(longest, 2.6);
}

TEST(Flat, NothingStandsInTheWayOfTheLoop) {
  const auto loop = flat_loop();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d a = loop[i], b = loop[(i + 1) % loop.size()];
    const Eigen::Vector2d along = (b - a).normalized();
    for (const double height : {0.3, 1.0, 1.6}) {
      const Vector3d from(a.x(), a.y(), height), to(b.x(), b.y(), height);
      const Se3 pose = looking(from, to);
      Camera camera = wide_camera(9, 5);
      camera.fx = camera.fy = 60.0;  // a narrow beam along the way
      const Rendering seen = in_flat().render(camera, [&](double) { return pose; }, 0.0, {});
      double nearest = 0.0;
      cv::minMaxLoc(seen.depth, &nearest, nullptr);
      EXPECT_GT(nearest, (b - a).norm() + 0.25) << i << " at " << height << " m";
      // To both sides a shoulder's width.
      for (const double side : {-1.0, 1.0}) {
        const Vector3d beside = from + Vector3d(-along.y(), along.x(), 0.0) * side;
        const Se3 across = looking(from, beside);
        const Rendering wall = in_flat().render(camera, [&](double) { return across; }, 0.0, {});
        EXPECT_GT(wall.depth.at<float>(2, 4), 0.3F) << i << " at " << height << " m";
      }
    }
  }
}

TEST(Flat, CornersAllAlongTheLoop) {
  const auto loop = flat_loop();
  int poor = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d from = loop[i], to = loop[(i + 2) % loop.size()];
    const auto [count, cells] =
        corners(in_flat(), {from.x(), from.y(), 1.5}, {to.x(), to.y(), 1.3});
    EXPECT_GT(count, 250U) << i;
    poor += cells < 20 ? 1 : 0;
  }
  EXPECT_LE(poor, 3);
}

/// A point that stands still has the same depth and the same colour from elsewhere.
TEST(Office, PointsAgreeBetweenTwoPlacesOfTheCamera) {
  const Camera camera = wide_camera(640, 480);
  const Se3 pose_a = looking({0, 0, 1.4}, {0, 2, 1.0});
  const Se3 pose_b = looking({0.06, 0.03, 1.42}, {0.05, 2, 1.0});
  const Rendering a = in_office().render(camera, [&](double) { return pose_a; }, 0.0, {});
  const Rendering b = in_office().render(camera, [&](double) { return pose_b; }, 0.0, {});
  const Se3 b_from_a = pose_b.inverse() * pose_a;
  std::vector<double> depth_gaps, colour_gaps;
  for (int y = 2; y < camera.height; y += 3) {
    for (int x = 2; x < camera.width; x += 3) {
      const Vector3d p =
          b_from_a * camera.unproject(Eigen::Vector2d(x, y), a.depth.at<float>(y, x));
      const Eigen::Vector2d pixel = camera.project(p);
      const cv::Point at(cvFloor(pixel.x()), cvFloor(pixel.y()));
      if (at.x < 0 || at.y < 0 || at.x + 1 >= camera.width || at.y + 1 >= camera.height) continue;
      double low = 0.0, high = 0.0;
      cv::minMaxLoc(b.depth(cv::Rect(at.x, at.y, 2, 2)), &low, &high);
      // Hidden in b, or at the edge of a surface.
      if (high - low > 0.02 * low || p.z() > high + 0.05) continue;
      const double fx = pixel.x() - at.x, fy = pixel.y() - at.y;
      // Inverse depth is what is linear across a plane's image.
      const auto inverse = [&](int dx, int dy) {
        return 1.0 / b.depth.at<float>(at.y + dy, at.x + dx);
      };
      const double top = inverse(0, 0) * (1 - fx) + inverse(1, 0) * fx;
      const double bottom = inverse(0, 1) * (1 - fx) + inverse(1, 1) * fx;
      depth_gaps.push_back(std::abs(1.0 / (top * (1 - fy) + bottom * fy) - p.z()));
      cv::Mat colour;
      cv::getRectSubPix(b.radiance, {1, 1},
                        {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}, colour);
      colour_gaps.push_back(
          std::abs(colour.at<cv::Vec3f>(0, 0)[1] - a.radiance.at<cv::Vec3f>(y, x)[1]));
    }
  }
  ASSERT_GT(depth_gaps.size(), 20000U);
  std::sort(depth_gaps.begin(), depth_gaps.end());
  std::sort(colour_gaps.begin(), colour_gaps.end());
  EXPECT_LT(depth_gaps[depth_gaps.size() * 95 / 100], 1e-3);
  EXPECT_LT(colour_gaps[colour_gaps.size() / 2], 0.005);
  EXPECT_LT(colour_gaps[colour_gaps.size() * 9 / 10], 0.05);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/dense/level_frame.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

constexpr double widest = 0.7071;       // cosine of 45 degrees
constexpr double alike = 0.985;         // of 10 degrees
constexpr double bin = 0.03;            // metres of height
constexpr double share_of_floor = 0.1;  // of what faces up
constexpr double narrowest = 0.1;       // metres, standard deviation of a floor's width
constexpr std::size_t fewest = 200;     // vertices that face up, to speak of a floor

Vector3d mean_up(std::span<const StampedPose> path) {
  Vector3d sum = Vector3d::Zero();
  for (const StampedPose& pose : path) {
    sum -= pose.world_from_camera.rotation * Vector3d::UnitY();
  }
  return sum.norm() > 1e-6 ? Vector3d(sum.normalized()) : Vector3d(0.0, -1.0, 0.0);
}

/// Vertices whose normals lie within an angle, by its cosine, of a direction.
std::vector<std::size_t> facing(const SurfaceMesh& mesh, const Vector3d& direction, double cosine) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i].cast<double>().dot(direction) > cosine) found.push_back(i);
  }
  return found;
}

/// The direction that most normals of a set share: of a few of them the one with most others near,
/// and then the mean of these, again and again.
Vector3d common_direction(const SurfaceMesh& mesh, const std::vector<std::size_t>& among) {
  constexpr std::size_t tries = 100;
  Vector3d best = mesh.normals[among.front()].cast<double>();
  std::size_t most = 0;
  for (std::size_t t = 0; t < tries; ++t) {
    const Vector3d tried = mesh.normals[among[t * among.size() / tries]].cast<double>();
    const std::size_t count = facing(mesh, tried, alike).size();
    if (count > most) {
      most = count;
      best = tried;
    }
  }
  for (int i = 0; i < 10; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (const std::size_t k : facing(mesh, best, alike)) sum += mesh.normals[k].cast<double>();
    best = sum.normalized();
  }
  return best;
}

/// Height of the lowest level that holds a good part of these vertices.
double lowest_level(const SurfaceMesh& mesh, const std::vector<std::size_t>& vertices,
                    const Vector3d& up) {
  std::vector<double> heights;
  for (const std::size_t i : vertices) heights.push_back(mesh.vertices[i].cast<double>().dot(up));
  std::sort(heights.begin(), heights.end());
  const auto enough = static_cast<std::size_t>(share_of_floor * double(heights.size()));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto end = std::upper_bound(heights.begin(), heights.end(), heights[i] + bin);
    const auto count = static_cast<std::size_t>(end - heights.begin()) - i;
    if (count > enough) return heights[i + count / 2];
  }
  return heights.front();
}

/// Up and height of the plane through what lies near a level, in least squares: normals of single
/// vertices, seen at an angle, lean towards the cameras.
void fit_floor(const SurfaceMesh& mesh, Vector3d& up, double& height) {
  for (const double near : {0.06, 0.04, 0.03}) {
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double count = 0.0;
    for (const std::size_t i : facing(mesh, up, alike)) {
      const Vector3d p = mesh.vertices[i].cast<double>();
      if (std::abs(p.dot(up) - height) > near) continue;
      sum += p;
      squares += p * p.transpose();
      count += 1.0;
    }
    if (count < 3.0) return;
    const Vector3d mean = sum / count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / count -
                                                              mean * mean.transpose());
    const Vector3d normal = axes.eigenvectors().col(0);
    // A strip of floor tells nothing of its tilt across.
    if (axes.eigenvalues()(1) < narrowest * narrowest || std::abs(normal.dot(up)) < alike) return;
    up = normal.dot(up) > 0.0 ? normal : Vector3d(-normal);
    height = mean.dot(up);
  }
}

double lowest(const SurfaceMesh& mesh, const Vector3d& up) {
  double low = INFINITY;
  for (const auto& v : mesh.vertices) low = std::min(low, v.cast<double>().dot(up));
  return low;
}

}  // namespace

LevelFrame find_level(const SurfaceMesh& mesh, std::span<const StampedPose> path) {
  if (path.empty() || mesh.vertices.empty()) {
    throw Error("no floor can be looked for without poses and surfaces");
  }
  Vector3d up = mean_up(path);
  const std::vector<std::size_t> upwards = facing(mesh, up, widest);
  LevelFrame level;
  level.found = upwards.size() >= fewest;
  double floor = 0.0;
  if (level.found) {
    up = common_direction(mesh, upwards);
    floor = lowest_level(mesh, facing(mesh, up, alike), up);
    fit_floor(mesh, up, floor);
  } else {
    floor = lowest(mesh, up);
  }
  const Se3& first = path.front().world_from_camera;
  Vector3d ahead = first.rotation * Vector3d::UnitZ();
  ahead -= ahead.dot(up) * up;
  if (ahead.norm() < 1e-3) ahead = up.unitOrthogonal();
  ahead.normalize();
  Eigen::Matrix3d rows;
  rows << ahead.transpose(), up.cross(ahead).transpose(), up.transpose();
  const Eigen::Quaterniond rotation(rows);
  const Vector3d foot = first.translation + (floor - first.translation.dot(up)) * up;
  level.level_from_world = Se3(rotation, -(rotation * foot));
  return level;
}

}  // namespace dkp_slam

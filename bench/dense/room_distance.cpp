#include "bench/dense/room_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <Eigen/Geometry>

namespace dkp_slam::bench {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double search_cell = 0.1;  // metres
constexpr int rings = 3;             // RoomDistance::farthest in cells

Vector3i cell_of(const Vector3d& p) { return (p / search_cell).array().floor().cast<int>(); }

double to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double length = d.squaredNorm();
  const double t = length > 0.0 ? std::clamp((p - a).dot(d) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

double to_triangle(const Vector3d& p, const std::array<Vector3d, 3>& t) {
  const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double double_area = normal.squaredNorm();
  bool inside = double_area > 0.0;
  double nearest = INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &a = t[i], &b = t[(i + 1) % 3];
    inside = inside && (b - a).cross(p - a).dot(normal) >= 0.0;
    nearest = std::min(nearest, to_segment(p, a, b));
  }
  return inside ? std::abs((p - t[0]).dot(normal)) / std::sqrt(double_area) : nearest;
}

}  // namespace

RoomDistance::RoomDistance(const std::vector<Mesh>& meshes) : cells_(1U << 30U) {
  for (const Mesh& mesh : meshes) {
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto at = [&](int i) -> Vector3d {
        return mesh.rest.vertices[static_cast<std::size_t>(t[i])].cast<double>();
      };
      add({at(0), at(1), at(2)});
    }
  }
}

void RoomDistance::add(const Triangle& t) {
  const Vector3i low = cell_of(t[0].cwiseMin(t[1]).cwiseMin(t[2]));
  const Vector3i high = cell_of(t[0].cwiseMax(t[1]).cwiseMax(t[2]));
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const Vector3i cell(x, y, z);
        cells_.add(cells_.block_of(cell));
        (*cells_.find(cells_.block_of(cell)))[cells_.index_in_block(cell)].push_back(
            static_cast<int>(triangles_.size()));
      }
    }
  }
  triangles_.push_back(t);
}

double RoomDistance::nearest_in(const Vector3i& cell, const Vector3d& point, double best) const {
  const std::vector<int>* there = cells_.cell(cell);
  if (!there) return best;
  for (const int i : *there) {
    best = std::min(best, to_triangle(point, triangles_[static_cast<std::size_t>(i)]));
  }
  return best;
}

double RoomDistance::operator()(const Vector3d& point) const {
  const Vector3i centre = cell_of(point);
  double best = farthest;
  for (int r = 0; r <= rings && best > (r - 1) * search_cell; ++r) {
    for (int z = -r; z <= r; ++z) {
      for (int y = -r; y <= r; ++y) {
        for (int x = -r; x <= r; ++x) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != r) continue;
          best = nearest_in(centre + Vector3i(x, y, z), point, best);
        }
      }
    }
  }
  return best;
}

}  // namespace dkp_slam::bench

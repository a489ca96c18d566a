#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/dense/block_grid.h"
#include "dkp_slam/synth/mesh/mesh.h"

namespace dkp_slam::bench {

/// How far points are from the surfaces of the generated world.
class RoomDistance {
 public:
  explicit RoomDistance(const std::vector<Mesh>& meshes);

  /// Metres to the nearest triangle; `farthest` where that is farther.
  double operator()(const Eigen::Vector3d& point) const;

  static constexpr double farthest = 0.3;

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;
  void add(const Triangle& triangle);
  double nearest_in(const Eigen::Vector3i& cell, const Eigen::Vector3d& point, double best) const;

  std::vector<Triangle> triangles_;
  BlockGrid<std::vector<int>> cells_;  ///< triangles whose bounds touch a cell
};

}  // namespace dkp_slam::bench

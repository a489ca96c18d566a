#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dkp_slam {

/// A coloured surface of triangles.
struct SurfaceMesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres, world frame
  std::vector<Eigen::Vector3f> normals;   ///< unit length, into free space; of each vertex
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< red, green, blue; of each vertex
  std::vector<std::array<int, 3>> triangles;  ///< vertices, counter-clockwise seen from free space
};

}  // namespace dkp_slam

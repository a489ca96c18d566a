#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/synth/mesh/texture.h"

namespace dkp_slam {

using TexturePtr = std::shared_ptr<const Texture>;

/// Where a mesh's vertices are: metres, unit normals, one each a vertex.
struct MeshPose {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;
};

/// A textured surface of triangles, seen from both sides. Normals point outwards and are smooth
/// where the surface is; sharp edges have their vertices twice.
struct Mesh {
  MeshPose rest;
  std::vector<Eigen::Vector2f> uv;         ///< of each vertex, 0 to 1 over the texture
  std::vector<Eigen::Vector3i> triangles;  ///< vertices, counter-clockwise seen from outside
  TexturePtr texture;
  float glow = 0.0F;     ///< light of its own where the texture is white: screens, windows, lamps
  bool is_lamp = false;  ///< its glow goes with the lamps' brightness
};

/// origin + a edge_u + b edge_v with a and b in 0..1; the texture's u runs along `edge_u`, its top
/// row lies at b = 0. Edges at right angles; the outside is edge_u x edge_v.
Mesh panel_mesh(const Eigen::Vector3d& origin, const Eigen::Vector3d& edge_u,
                const Eigen::Vector3d& edge_v, TexturePtr texture);

/// A box around the origin, sides of `size` metres, the texture once on every face, upright.
Mesh box_mesh(const Eigen::Vector3d& size, const TexturePtr& texture);

/// A surface of revolution around z: `profile` holds (radius, z) from top to bottom, metres; the
/// texture goes once around, its middle column at +x, its top row at the profile's start.
Mesh lathe_mesh(const std::vector<Eigen::Vector2d>& profile, int sides, TexturePtr texture);

/// An ellipsoid around the origin, poles on z, texture as `lathe_mesh`.
Mesh ellipsoid_mesh(const Eigen::Vector3d& radii, int sides, TexturePtr texture);

/// The mesh at another place.
Mesh operator*(const Se3& world_from_mesh, const Mesh& mesh);
MeshPose operator*(const Se3& world_from_mesh, const MeshPose& pose);

}  // namespace dkp_slam

#include "dkp_slam/synth/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dkp_slam {
namespace {

void append(const Mesh& part, Mesh& whole) {
  const auto first = static_cast<int>(whole.rest.vertices.size());
  const auto add = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(part.rest.vertices, whole.rest.vertices);
  add(part.rest.normals, whole.rest.normals);
  add(part.uv, whole.uv);
  for (const Eigen::Vector3i& t : part.triangles) whole.triangles.push_back(t.array() + first);
}

}  // namespace

Mesh panel_mesh(const Eigen::Vector3d& origin, const Eigen::Vector3d& edge_u,
                const Eigen::Vector3d& edge_v, TexturePtr texture) {
  Mesh mesh;
  const Eigen::Vector3f normal = edge_u.cross(edge_v).normalized().cast<float>();
  for (const auto& [a, b] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    mesh.rest.vertices.emplace_back((origin + a * edge_u + b * edge_v).cast<float>());
    mesh.rest.normals.push_back(normal);
    mesh.uv.emplace_back(static_cast<float>(a), static_cast<float>(b));
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.texture = std::move(texture);
  return mesh;
}

Mesh box_mesh(const Eigen::Vector3d& size, const TexturePtr& texture) {
  Mesh mesh;
  mesh.texture = texture;
  const Eigen::Vector3d h = 0.5 * size;
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  // Seen from outside u runs to the right and v down.
  append(panel_mesh({-h.x(), -h.y(), h.z()}, x, -z, texture), mesh);  // front, -y
  append(panel_mesh({h.x(), h.y(), h.z()}, -x, -z, texture), mesh);   // back, +y
  append(panel_mesh({h.x(), -h.y(), h.z()}, y, -z, texture), mesh);   // right, +x
  append(panel_mesh({-h.x(), h.y(), h.z()}, -y, -z, texture), mesh);  // left, -x
  append(panel_mesh({-h.x(), h.y(), h.z()}, x, -y, texture), mesh);   // top
  append(panel_mesh({-h.x(), -h.y(), -h.z()}, x, y, texture), mesh);  // bottom
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    // The panels' own outside is edge_u x edge_v, which points inwards here.
    std::swap(mesh.triangles[t].y(), mesh.triangles[t].z());
  }
  for (Eigen::Vector3f& n : mesh.rest.normals) n = -n;
  return mesh;
}

Mesh lathe_mesh(const std::vector<Eigen::Vector2d>& profile, int sides, TexturePtr texture) {
  Mesh mesh;
  mesh.texture = std::move(texture);
  const auto rows = static_cast<int>(profile.size());
  for (int r = 0; r < rows; ++r) {
    const auto at = [&](int i) {
      return profile[static_cast<std::size_t>(std::clamp(i, 0, rows - 1))];
    };
    const Eigen::Vector2d along = (at(r + 1) - at(r - 1)).normalized();
    const Eigen::Vector2d out(-along.y(), along.x());  // of (radius, z), the profile runs down
    for (int s = 0; s <= sides; ++s) {
      const double u = static_cast<double>(s) / sides;
      const double angle = 2.0 * std::numbers::pi * (u - 0.5);
      const Eigen::Vector3d around(std::cos(angle), std::sin(angle), 0.0);
      const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
      mesh.rest.vertices.emplace_back((at(r).x() * around + at(r).y() * z).cast<float>());
      mesh.rest.normals.emplace_back((out.x() * around + out.y() * z).cast<float>());
      mesh.uv.emplace_back(static_cast<float>(u),
                           static_cast<float>(r) / static_cast<float>(rows - 1));
    }
  }
  for (int r = 0; r + 1 < rows; ++r) {
    for (int s = 0; s < sides; ++s) {
      const int a = r * (sides + 1) + s, below = a + sides + 1;
      mesh.triangles.emplace_back(a, below, below + 1);
      mesh.triangles.emplace_back(a, below + 1, a + 1);
    }
  }
  return mesh;
}

Mesh ellipsoid_mesh(const Eigen::Vector3d& radii, int sides, TexturePtr texture) {
  const int rows = sides / 2 + 1;
  std::vector<Eigen::Vector2d> profile;
  for (int r = 0; r < rows; ++r) {
    const double angle = std::numbers::pi * r / (rows - 1);
    profile.emplace_back(std::sin(angle), std::cos(angle));
  }
  Mesh mesh = lathe_mesh(profile, sides, std::move(texture));
  for (std::size_t i = 0; i < mesh.rest.vertices.size(); ++i) {
    Eigen::Vector3f& v = mesh.rest.vertices[i];
    mesh.rest.normals[i] = v.cwiseQuotient(radii.cast<float>()).normalized();
    v = v.cwiseProduct(radii.cast<float>()).eval();
  }
  return mesh;
}

MeshPose operator*(const Se3& world_from_mesh, const MeshPose& pose) {
  const Eigen::Matrix3f rotation = world_from_mesh.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = world_from_mesh.translation.cast<float>();
  MeshPose moved = pose;
  for (Eigen::Vector3f& v : moved.vertices) v = (rotation * v + translation).eval();
  for (Eigen::Vector3f& n : moved.normals) n = (rotation * n).eval();
  return moved;
}

Mesh operator*(const Se3& world_from_mesh, const Mesh& mesh) {
  Mesh moved = mesh;
  moved.rest = world_from_mesh * mesh.rest;
  return moved;
}

}  // namespace dkp_slam

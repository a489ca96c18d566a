#include "dkp_slam/synth/room/furniture_kit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "dkp_slam/synth/mesh/texture.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Face {
  Vector3d corner, right, down;  ///< seen from outside
};

std::array<Face, 6> faces_of(const Vector3d& size) {
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const Vector3d lowest = -0.5 * size, top = lowest + z;
  return {{{top, x, -z},           // front, -y
           {top + x + y, -x, -z},  // back
           {top + x, y, -z},       // right
           {top + y, -y, -z},      // left
           {top + y, x, -y},       // top
           {lowest, x, y}}};       // bottom
}

/// A part of a material of width x height metres, as (u, v) of its corner and along its sides.
struct Cut {
  Vector2d at, right, down;
};

Cut cut(cv::RNG& rng, const Material& material, double width, double height) {
  // The grain runs along u: lengthwise.
  const bool turned = height > width;
  const double u = std::min(std::max(width, height) / material.metres, 1.0);
  const double v = std::min(std::min(width, height) / material.metres, 1.0);
  Cut part;
  part.at.x() = rng.uniform(0.0, 1.0) * (1.0 - u);
  part.at.y() = rng.uniform(0.0, 1.0) * (1.0 - v);
  part.right = turned ? Vector2d(0.0, v) : Vector2d(u, 0.0);
  part.down = turned ? Vector2d(u, 0.0) : Vector2d(0.0, v);
  return part;
}

void add_face(const Face& face, const Cut& part, Mesh* mesh) {
  const auto first = static_cast<int>(mesh->rest.vertices.size());
  const Eigen::Vector3f normal = face.down.cross(face.right).normalized().cast<float>();
  for (const auto& [a, b] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    mesh->rest.vertices.emplace_back((face.corner + a * face.right + b * face.down).cast<float>());
    mesh->rest.normals.push_back(normal);
    mesh->uv.emplace_back((part.at + a * part.right + b * part.down).cast<float>());
  }
  mesh->triangles.emplace_back(first, first + 3, first + 2);
  mesh->triangles.emplace_back(first, first + 2, first + 1);
}

Material material_of(const cv::Mat& print, double metres) { return {make_texture(print), metres}; }

}  // namespace

TexturePtr make_texture(const cv::Mat& print) { return std::make_shared<Texture>(print); }

Se3 standing(const Vector3d& foot, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())), foot};
}

Material FurnitureKit::wood(const cv::Scalar& colour) {
  return material_of(grain_print(rng, {768, 768}, colour), 2.0);
}
Material FurnitureKit::cloth(const cv::Scalar& colour) {
  return material_of(weave_print(rng, {384, 384}, colour), 0.8);
}
Material FurnitureKit::smooth(const cv::Scalar& colour) {
  return material_of(smooth_print(rng, {256, 256}, colour), 1.0);
}

void FurnitureKit::block(const Vector3d& centre, const Vector3d& size, const Material& material,
                         double yaw) {
  Mesh mesh;
  mesh.texture = material.texture;
  for (const Face& face : faces_of(size)) {
    add_face(face, cut(rng, material, face.right.norm(), face.down.norm()), &mesh);
  }
  meshes.push_back(standing(centre, yaw) * mesh);
}

void FurnitureKit::cushion(const Vector3d& centre, const Vector3d& size, double radius,
                           const Material& material) {
  Mesh mesh;
  mesh.texture = material.texture;
  const Vector3d inner = (0.5 * size).array() - radius;
  // Steps that end in the middle of the rounding, where most of its bend is.
  const std::array<double, 6> steps = {0.0, 0.06, 0.2, 0.8, 0.94, 1.0};
  const auto count = static_cast<int>(steps.size());
  for (const Face& face : faces_of(size)) {
    const Cut part = cut(rng, material, face.right.norm(), face.down.norm());
    const auto first = static_cast<int>(mesh.rest.vertices.size());
    for (const double b : steps) {
      for (const double a : steps) {
        const Vector3d cube = face.corner + a * face.right + b * face.down;
        const Vector3d core = cube.cwiseMax(-inner).cwiseMin(inner);
        const Vector3d normal = (cube - core).normalized();
        mesh.rest.vertices.emplace_back((centre + core + radius * normal).cast<float>());
        mesh.rest.normals.emplace_back(normal.cast<float>());
        mesh.uv.emplace_back((part.at + a * part.right + b * part.down).cast<float>());
      }
    }
    for (int j = 0; j + 1 < count; ++j) {
      for (int i = 0; i + 1 < count; ++i) {
        const int k = first + j * count + i;
        mesh.triangles.emplace_back(k, k + count, k + count + 1);
        mesh.triangles.emplace_back(k, k + count + 1, k + 1);
      }
    }
  }
  meshes.push_back(std::move(mesh));
}

void FurnitureKit::picture(const Vector3d& corner, const Vector3d& right, const Vector3d& down,
                           TexturePtr print, float glow) {
  Mesh mesh;
  mesh.texture = std::move(print);
  mesh.glow = glow;
  add_face({corner, right, down}, {{0, 0}, {1, 0}, {0, 1}}, &mesh);
  meshes.push_back(std::move(mesh));
}

void FurnitureKit::turned(const Vector3d& foot, const std::vector<Vector2d>& profile, int sides,
                          const Material& material) {
  meshes.push_back(standing(foot, 0.0) * lathe_mesh(profile, sides, material.texture));
}

void FurnitureKit::place(const std::vector<Mesh>& piece, const Vector3d& foot, double yaw) {
  const Se3 pose = standing(foot, yaw);
  for (const Mesh& mesh : piece) meshes.push_back(pose * mesh);
}

}  // namespace dkp_slam

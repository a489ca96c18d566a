#include "dkp_slam/dense/mesh_files.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

template <class Value>
void put(std::ostream& out, const Value& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_vector(std::ostream& out, const Eigen::Vector3f& v) {
  out.write(reinterpret_cast<const char*>(v.data()), 3 * sizeof(float));
}

std::string ply_header(const SurfaceMesh& mesh, bool triangles) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment metres, world frame of the trajectory\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n",
      mesh.vertices.size());
  if (triangles) {
    text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n",
                        mesh.triangles.size());
  }
  return text + "end_header\n";
}

/// From x right, y down, z forward.
Eigen::Vector3f in_gltf(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }

/// What tells where the numbers of the .glb lie and what they are.
std::string gltf_json(const SurfaceMesh& mesh) {
  constexpr int floats = 5126, integers = 5125, bytes = 5121;  // glTF 2.0, 3.6.2
  constexpr int vertex_data = 34962, index_data = 34963;
  Eigen::Array3f low = Eigen::Array3f::Constant(INFINITY), high = -low;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    low = low.min(in_gltf(v).array());
    high = high.max(in_gltf(v).array());
  }
  const std::size_t n = mesh.vertices.size(), m = 3 * mesh.triangles.size();
  const auto triple = [](const Eigen::Array3f& v) {
    return fmt::format("[{},{},{}]", v.x(), v.y(), v.z());
  };
  const auto view = [](std::size_t offset, std::size_t length, int target) {
    return fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}})", offset,
                       length, target);
  };
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"dkp-slam"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"name":"static world","mesh":0}}],)"
      R"("materials":[{{"doubleSided":true,"pbrMetallicRoughness":{{"metallicFactor":0}}}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"COLOR_0":2}},)"
      R"("indices":3,"material":0}}]}}],"accessors":[)"
      R"({{"bufferView":0,"componentType":{},"count":{},"type":"VEC3","min":{},"max":{}}},)"
      R"({{"bufferView":1,"componentType":{},"count":{},"type":"VEC3"}},)"
      R"({{"bufferView":2,"componentType":{},"normalized":true,"count":{},"type":"VEC4"}},)"
      R"({{"bufferView":3,"componentType":{},"count":{},"type":"SCALAR"}}],)"
      R"("bufferViews":[{},{},{},{}],"buffers":[{{"byteLength":{}}}]}})",
      +floats, n, triple(low), triple(high), +floats, n, +bytes, n, +integers, m,
      view(0, 12 * n, vertex_data), view(12 * n, 12 * n, vertex_data),
      view(24 * n, 4 * n, vertex_data), view(28 * n, 4 * m, index_data), 28 * n + 4 * m);
}

void check(const std::filesystem::path& file, bool empty) {
  if (!empty) return;
  throw Error(
      fmt::format("{}: not written: there is no surface; were all depth images masked, or "
                  "too few views fused?",
                  file.string()));
}

}  // namespace

void write_mesh_ply(const std::filesystem::path& file, const SurfaceMesh& mesh, bool triangles) {
  check(file, mesh.vertices.empty());
  write_file_atomically(file, [&](std::ostream& out) {
    out << ply_header(mesh, triangles);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      put_vector(out, mesh.vertices[i]);
      put_vector(out, mesh.normals[i]);
      put(out, mesh.colours[i]);
    }
    if (!triangles) return;
    for (const auto& t : mesh.triangles) {
      put(out, std::uint8_t{3});
      put(out, t);
    }
  });
}

void write_mesh_glb(const std::filesystem::path& file, const SurfaceMesh& mesh) {
  check(file, mesh.triangles.empty());
  std::string json = gltf_json(mesh);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto binary =
      static_cast<std::uint64_t>(28 * mesh.vertices.size() + 12 * mesh.triangles.size());
  constexpr std::uint64_t headers = 12 + 8 + 8;
  if (headers + json.size() + binary > UINT32_MAX) {
    throw Error(fmt::format("{}: a .glb holds 4 GB at most; write .ply, or take larger voxels",
                            file.string()));
  }
  constexpr std::uint32_t version = 2, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
  write_file_atomically(file, [&](std::ostream& out) {
    out << std::string_view("glTF");
    for (const std::uint64_t word : {std::uint64_t{version}, headers + json.size() + binary,
                                     std::uint64_t{json.size()}, std::uint64_t{json_chunk}}) {
      put(out, static_cast<std::uint32_t>(word));
    }
    out << json;
    put(out, static_cast<std::uint32_t>(binary));
    put(out, binary_chunk);
    for (const Eigen::Vector3f& v : mesh.vertices) put_vector(out, in_gltf(v));
    for (const Eigen::Vector3f& v : mesh.normals) put_vector(out, in_gltf(v));
    for (const auto& c : mesh.colours) {
      put(out, c);
      put(out, std::uint8_t{255});
    }
    for (const auto& t : mesh.triangles) put(out, t);
  });
}

}  // namespace dkp_slam

#include "dkp_slam/dense/mesh_files.h"

#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;

SurfaceMesh one_triangle() {
  SurfaceMesh mesh;
  mesh.vertices = {{0.0F, 0.0F, 1.0F}, {0.5F, 0.0F, 1.0F}, {0.0F, 0.25F, 2.0F}};
  mesh.normals.assign(3, {0.0F, 0.0F, -1.0F});
  mesh.colours = {{1, 2, 3}, {4, 5, 6}, {7, 8, 255}};
  mesh.triangles = {{0, 2, 1}};
  return mesh;
}

using MeshFiles = testing::FolderTest;

template <class Value>
Value at(const std::string& bytes, std::size_t offset) {
  Value value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST_F(MeshFiles, PlyHoldsVerticesAndWhereWantedFaces) {
  const auto file = folder_ / "m.ply";
  write_mesh_ply(file, one_triangle(), true);
  const std::string text = testing::content(file);
  EXPECT_THAT(text, ::testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, HasSubstr("element vertex 3\n"));
  EXPECT_THAT(text, HasSubstr("element face 1\n"));
  const std::size_t begin = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size(), begin + 3 * 27 + 13);
  EXPECT_EQ(at<float>(text, begin + 27), 0.5F);
  EXPECT_EQ(at<float>(text, begin + 20), -1.0F);
  EXPECT_EQ(at<std::uint8_t>(text, begin + 3 * 27 - 1), 255);
  EXPECT_EQ(at<std::uint8_t>(text, begin + 3 * 27), 3);
  EXPECT_EQ(at<int>(text, begin + 3 * 27 + 5), 2);
  write_mesh_ply(file, one_triangle(), false);
  EXPECT_EQ(testing::content(file).size(),
            testing::content(file).find("end_header\n") + 11 + 3 * 27);
  EXPECT_THAT(testing::content(file), ::testing::Not(HasSubstr("face")));
}

TEST_F(MeshFiles, GlbIsInGltfsAxes) {
  const auto file = folder_ / "m.glb";
  write_mesh_glb(file, one_triangle());
  const std::string bytes = testing::content(file);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), bytes.size());
  const auto length = at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(length % 4, 0U);
  const auto json = nlohmann::json::parse(bytes.substr(20, length));
  const auto& position = json.at("accessors").at(0);
  EXPECT_EQ(position.at("count"), 3);
  EXPECT_EQ(position.at("min"), nlohmann::json({0, -0.25, -2}));
  EXPECT_EQ(position.at("max"), nlohmann::json({0.5, 0, -1}));
  const std::size_t data = 20 + length + 8;
  EXPECT_EQ(at<std::uint32_t>(bytes, data - 8), bytes.size() - data);
  EXPECT_EQ(json.at("buffers").at(0).at("byteLength"), bytes.size() - data);
  for (const auto& view : json.at("bufferViews")) {
    EXPECT_LE(view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>(),
              bytes.size() - data);
  }
  EXPECT_EQ(at<float>(bytes, data + 12), 0.5F);
  EXPECT_EQ(at<float>(bytes, data + 2 * 12 + 4), -0.25F);
  EXPECT_EQ(at<int>(bytes, data + 28 * 3 + 4), 2);
}

TEST_F(MeshFiles, AnEmptyMeshIsRefusedAndTheOldFileStays) {
  const auto file = folder_ / "m.ply";
  write_mesh_ply(file, one_triangle(), true);
  const std::string before = testing::content(file);
  EXPECT_THROW(write_mesh_ply(file, {}, true), Error);
  EXPECT_EQ(testing::content(file), before);
  EXPECT_THROW(write_mesh_glb(folder_ / "m.glb", {}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.glb"));
}

}  // namespace
}  // namespace dkp_slam

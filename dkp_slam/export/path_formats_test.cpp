#include "dkp_slam/export/path_formats.h"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;

/// A quarter turn about z at (1, 2, 3), and no turn at the origin.
Trajectory two_poses() {
  const Eigen::Quaterniond quarter(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  return {{1305031910.765432, {quarter, {1.0, 2.0, 3.0}}}, {1305031911.0, {}}};
}

std::string text_of(PathFormat format) { return path_text(format, two_poses()); }

TEST(PathFormats, TumIsTheBenchmarks) {
  EXPECT_EQ(text_of(PathFormat::tum),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1305031910.765432 1.0000000 2.0000000 3.0000000 0.000000000 0.000000000 0.707106781 "
            "0.707106781\n"
            "1305031911.000000 0.0000000 0.0000000 0.0000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
}

TEST(PathFormats, KittiIsTheMatrixRowByRow) {
  EXPECT_EQ(text_of(PathFormat::kitti),
            "0.000000000 -1.000000000 0.000000000 1.000000000 "
            "1.000000000 0.000000000 0.000000000 2.000000000 "
            "0.000000000 0.000000000 1.000000000 3.000000000\n"
            "1.000000000 0.000000000 0.000000000 0.000000000 "
            "0.000000000 1.000000000 0.000000000 0.000000000 "
            "0.000000000 0.000000000 1.000000000 0.000000000\n");
}

TEST(PathFormats, EurocHasNanosecondsAndTheScalarFirst) {
  EXPECT_EQ(text_of(PathFormat::euroc),
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y "
            "[],q_RS_z []\n"
            "1305031910765432000,1.0000000,2.0000000,3.0000000,0.707106781,0.000000000,"
            "0.000000000,0.707106781\n"
            "1305031911000000000,0.0000000,0.0000000,0.0000000,1.000000000,0.000000000,"
            "0.000000000,0.000000000\n");
}

TEST(PathFormats, PlyHasVerticesAndTheWayBetweenThem) {
  EXPECT_THAT(text_of(PathFormat::ply),
              ::testing::AllOf(HasSubstr("element vertex 2\n"), HasSubstr("element edge 1\n"),
                               HasSubstr("end_header\n"
                                         "1.000000 2.000000 3.000000 1305031910.765432\n"
                                         "0.000000 0.000000 0.000000 1305031911.000000\n"
                                         "0 1\n")));
}

TEST(PathFormats, GltfIsALineStripInItsAxes) {
  const auto json = nlohmann::json::parse(text_of(PathFormat::gltf));
  EXPECT_EQ(json.at("asset").at("version"), "2.0");
  EXPECT_EQ(json.at("meshes").at(0).at("primitives").at(0).at("mode"), 3);
  const auto& accessor = json.at("accessors").at(0);
  EXPECT_EQ(accessor.at("count"), 2);
  EXPECT_EQ(accessor.at("min"), nlohmann::json({0, -2, -3}));
  EXPECT_EQ(accessor.at("max"), nlohmann::json({1, 0, 0}));
  EXPECT_EQ(json.at("buffers").at(0).at("byteLength"), 24);
  // 1, -2, -3 and zeros (which may be negative ones) as 32-bit floats.
  EXPECT_THAT(json.at("buffers").at(0).at("uri").get<std::string>(),
              ::testing::StartsWith("data:application/octet-stream;base64,AACAPwAAAMAAAEDA"));
}

TEST(PathFormats, RefusesWhatIsNoPath) {
  for (const PathFormatInfo& info : path_formats()) {
    EXPECT_THROW(path_text(info.format, {}), Error) << info.name;
    Trajectory broken = two_poses();
    broken[1].world_from_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(path_text(info.format, broken), Error) << info.name;
  }
}

}  // namespace
}  // namespace dkp_slam

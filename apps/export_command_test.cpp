#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::GrowingMap;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExportCommand : public testing::CommandTest {
 protected:
  /// Fails with this exit code and a message that holds `why`.
  void expect_refused(int code, const std::vector<std::string>& arguments, const std::string& why) {
    EXPECT_EQ(call({"export"}, arguments), code) << stderr_;
    EXPECT_THAT(stderr_, HasSubstr(why));
  }
  fs::path trajectory() const {
    const fs::path file = folder_ / "path.txt";
    Trajectory path{{10.0, {}}, {10.5, {}}};
    path[1].world_from_camera.translation = {1.0, 2.0, 3.0};
    write_trajectory(file, path);
    return file;
  }
  /// A run along a wall two metres away that keeps its masks.
  fs::path finished_run() {
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", 12);
    EXPECT_EQ(call({"run", sequence_->folder(), "--mode", "off", "--save-masks", "--out", run()}),
              0)
        << stderr_;
    return run();
  }
  fs::path run() const { return folder_ / "run"; }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(ExportCommand, APathInEveryFormat) {
  const auto exported = [&](const std::string& name, const std::vector<std::string>& more) {
    EXPECT_EQ(call({"export", trajectory(), "--out", folder_ / name}, more), 0) << stderr_;
    return content(folder_ / name);
  };
  EXPECT_EQ(exported("p.txt", {}), content(trajectory()));
  EXPECT_THAT(exported("p.kitti.txt", {"--format", "kitti"}),
              ::testing::EndsWith(" 0.000000000 0.000000000 1.000000000 3.000000000\n"));
  EXPECT_THAT(exported("p.csv", {}), HasSubstr("10500000000,1.0000000,2.0000000,3.0000000,"));
  EXPECT_THAT(exported("p.ply", {}), HasSubstr("element edge 1\n"));
  EXPECT_EQ(nlohmann::json::parse(exported("p.gltf", {})).at("accessors").at(0).at("count"), 2);
}

TEST_F(ExportCommand, AMapGivesItsKeyframesAndLandmarks) {
  GrowingMap grown;
  grown.grow_to(30);
  const fs::path map = folder_ / "room.map";
  save_map(map, grown.map);
  const fs::path out = folder_ / "path.txt", points = folder_ / "points.ply";
  ASSERT_EQ(call({"export", map, "--out", out, "--landmarks", points}), 0) << stderr_;
  const auto keyframes = [&](int id) { return grown.map.keyframes_in(id).size(); };
  EXPECT_EQ(read_trajectory(out).size(), std::max(keyframes(0), keyframes(1)));
  EXPECT_THAT(content(points),
              HasSubstr(fmt::format("element vertex {}\n", grown.map.live_landmarks())));
  ASSERT_EQ(call({"export", map, "--out", out, "--map-id", "1"}), 0) << stderr_;
  EXPECT_EQ(read_trajectory(out).size(), keyframes(1));
  expect_refused(1, {map, "--out", out, "--map-id", "7"}, "has no map 7 (--map-id)");
  expect_refused(2, {map, "--dense", folder_ / "d.ply"}, "is a map file, which holds no images");
}

TEST_F(ExportCommand, AnEmptyMapIsRefused) {
  const fs::path map = folder_ / "empty.map";
  create_map_file(map, Map(testing::test_camera(), 1.2F, 8));
  expect_refused(1, {map, "--landmarks", folder_ / "p.ply"}, "the map holds no keyframe");
  EXPECT_FALSE(fs::exists(folder_ / "p.ply"));
}

/// Vertices of a PLY file of `export`.
std::vector<Eigen::Vector3f> vertices(const fs::path& file) {
  const std::string bytes = content(file);
  std::size_t at = bytes.find("end_header\n") + 11;
  std::vector<Eigen::Vector3f> all;
  const std::size_t count = std::stoul(bytes.substr(bytes.find("element vertex ") + 15));
  for (std::size_t i = 0; i < count; ++i, at += 27) {
    all.emplace_back();
    std::memcpy(all.back().data(), bytes.data() + at, 12);
  }
  return all;
}

TEST_F(ExportCommand, ARunGivesTheStaticWorld) {
  const fs::path cloud = folder_ / "c.ply", mesh = folder_ / "m.glb", grid = folder_ / "g.pgm";
  std::vector<std::string> arguments{"export",  finished_run(), "--dense", cloud, "--mesh", mesh,
                                     "--grid",  grid,           "--low",   "-5",  "--high", "5",
                                     "--voxel", "0.04"};
  if (has_octomap()) arguments.insert(arguments.end(), {"--octomap", folder_ / "o.bt"});
  ASSERT_EQ(call(arguments), 0) << stderr_;
  double sum = 0.0;
  const auto points = vertices(cloud);
  // 2.6 x 1.9 m of wall at 4 cm.
  EXPECT_GT(points.size(), 2500U);
  for (const auto& p : points) sum += std::abs(p.z() - WallSequence::depth);
  EXPECT_LT(sum / double(points.size()), 0.005);
  EXPECT_THAT(content(mesh), StartsWith("glTF"));
  EXPECT_THAT(content(grid), StartsWith("P5\n"));
  EXPECT_THAT(content(folder_ / "g.yaml"), HasSubstr("image: g.pgm\nresolution: 0.05\n"));
  EXPECT_THAT(stderr_, HasSubstr("no floor was seen"));
  if (has_octomap()) {
    EXPECT_THAT(content(folder_ / "o.bt"), StartsWith("# Octomap OcTree binary file\n"));
  }
  EXPECT_THAT(stdout_, StartsWith("12 images fused at 0.04 m: "));

  fs::create_symlink("/dev/full", folder_ / "full.ply");
  expect_refused(1, {run(), "--mesh", folder_ / "full.ply", "--voxel", "0.1"},
                 "No space left on device");

  // All that is masked stays out; one that is of another size is said.
  const fs::path mask = run() / "masks" / (WallSequence::stamp(0) + ".png");
  ASSERT_TRUE(fs::exists(mask));
  for (int i = 0; i < 12; ++i) {
    write_image(run() / "masks" / (WallSequence::stamp(i) + ".png"), cv::Mat(480, 640, CV_8U, 255));
  }
  const std::string before = content(cloud);
  expect_refused(1, {run(), "--dense", cloud}, "there is no surface");
  EXPECT_EQ(content(cloud), before);
  write_image(mask, cv::Mat(24, 32, CV_8U, 255));
  expect_refused(1, {run(), "--dense", cloud}, "the mask is 32 x 24 pixels");
  expect_refused(1, {run(), "--dense", cloud, "--masks", folder_ / "none"}, "no such folder");

  // Without any of them only who asks for it gets people.
  fs::remove_all(run() / "masks");
  expect_refused(1, {run(), "--dense", cloud}, "run again with --save-masks");
  EXPECT_EQ(call({"export", run(), "--dense", cloud, "--no-masks", "--voxel", "0.04"}), 0)
      << stderr_;
  expect_refused(1, {run(), "--dense", cloud, "--sequence", folder_ / "none"}, "no such folder");
  write_trajectory(folder_ / "other.txt", Trajectory{{500.0, {}}});
  expect_refused(
      1, {folder_ / "other.txt", "--dense", cloud, "--sequence", sequence_->folder(), "--no-masks"},
      "none of its images has the time stamp of a pose");
}

TEST_F(ExportCommand, WhatTheRunWasMadeOfMustBeThereAgain) {
  fs::create_directories(run());
  write_trajectory(run() / "trajectory.txt", read_trajectory(trajectory()));
  const auto made_of = [&](const std::string& sequence, const std::string& camera) {
    std::ofstream(run() / "summary.json")
        << fmt::format(R"({{"options": {{"sequence": "{}", "camera": "{}"}}}})", sequence, camera);
  };
  const fs::path cloud = folder_ / "c.ply";
  for (const char* live : {"-", "unix:/run/camera", "kinect"}) {
    made_of(live, "of the stream");
    expect_refused(1, {run(), "--dense", cloud, "--no-masks"}, "cannot be read again");
  }
  const WallSequence sequence(folder_ / "sequence", 2);
  made_of(sequence.folder(), folder_ / "gone.yaml");
  expect_refused(1, {run(), "--dense", cloud, "--no-masks"},
                 "gone.yaml: this camera of the run is not there any more");
}

TEST_F(ExportCommand, ARunWritesTheStaticWorldWhenItEnds) {
  const WallSequence sequence(folder_ / "sequence", 30);
  const fs::path cloud = folder_ / "c.ply", mesh = folder_ / "m.ply", grid = folder_ / "g.pgm";
  std::vector<std::string> arguments{"run",     sequence.folder(),
                                     "--mode",  "off",
                                     "--out",   run(),
                                     "--dense", cloud,
                                     "--mesh",  mesh,
                                     "--grid",  grid,
                                     "--low",   "-5",
                                     "--high",  "5",
                                     "--voxel", "0.04"};
  if (has_octomap()) arguments.insert(arguments.end(), {"--octomap", folder_ / "o.bt"});
  ASSERT_EQ(call(arguments), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr(" images fused at 0.04 m: "));
  EXPECT_THAT(stderr_, HasSubstr("mode off masks nothing: people are fused, too"));
  double sum = 0.0;
  const auto points = vertices(cloud);
  EXPECT_GT(points.size(), 2000U);
  for (const auto& p : points) sum += std::abs(p.z() - WallSequence::depth);
  EXPECT_LT(sum / double(points.size()), 0.005);
  EXPECT_THAT(content(grid), StartsWith("P5\n"));
  // Offline the same again, to the byte.
  const std::string first_cloud = content(cloud), first_mesh = content(mesh);
  ASSERT_EQ(call(arguments), 0) << stderr_;
  EXPECT_TRUE(content(cloud) == first_cloud);
  EXPECT_TRUE(content(mesh) == first_mesh);

  EXPECT_EQ(call({"run", sequence.folder(), "--out", folder_ / "no", "--mesh", folder_ / "m.obj"}),
            2);
  EXPECT_THAT(stderr_, HasSubstr("must end in .ply or .glb"));
  EXPECT_EQ(call({"run", sequence.folder(), "--out", folder_ / "no", "--dense",
                  folder_ / "none" / "c.ply"}),
            1);
  EXPECT_THAT(stderr_, HasSubstr("does not exist"));
  EXPECT_FALSE(fs::exists(folder_ / "no"));
}

TEST_F(ExportCommand, MisuseIsSaidBeforeAnythingIsDone) {
  const fs::path path = trajectory();
  expect_refused(2, {path}, "nothing to write");
  expect_refused(2, {path, "--out", folder_ / "p.xyz"}, "does not tell the format");
  expect_refused(2, {path, "--dense", folder_ / "c.ply", "--voxel", "0.001"}, "--voxel");
  expect_refused(2, {path, "--dense", folder_ / "c.ply", "--voxel", "fine"}, "--voxel");
  expect_refused(2, {path, "--mesh", folder_ / "m.obj"}, "must end in .ply or .glb");
  expect_refused(2, {path, "--landmarks", folder_ / "p.ply"}, "is no map file");
  expect_refused(1, {folder_ / "none.txt", "--out", folder_ / "p.ply"}, "none.txt");
  expect_refused(1, {folder_, "--out", folder_ / "p.ply"}, "holds no trajectory.txt");
  expect_refused(1, {path, "--out", folder_ / "none" / "p.ply"}, "does not exist");
  expect_refused(1, {path, "--dense", folder_ / "c.ply"}, "give the folder of the sequence");
  Trajectory far = read_trajectory(path);
  far.back().world_from_camera.translation.x() = 1e6;
  write_trajectory(folder_ / "far.txt", far);
  expect_refused(1, {folder_ / "far.txt", "--dense", folder_ / "c.ply", "--sequence", folder_},
                 "is the trajectory in metres?");
  expect_refused(1, {path, "--out", "/dev/full", "--format", "tum"}, "No space left on device");
}

}  // namespace
}  // namespace dkp_slam

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/sqlite.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using dkp_slam::testing::content;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::GrowingMap;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;

class MapCommand : public testing::CommandTest {
 protected:
  std::vector<std::string> run_arguments(const std::vector<std::string>& more) {
    if (!sequence_) sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
    std::vector<std::string> arguments{"run",      sequence_->folder(),
                                       "--camera", sequence_->folder() / "camera.yaml",
                                       "--mode",   "off",
                                       "--out",    out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  nlohmann::json info(const fs::path& file) {
    EXPECT_EQ(call({"map", "info", file, "--json"}), 0) << stderr_;
    return nlohmann::json::parse(stdout_);
  }
  /// A map file that was made without a run.
  fs::path saved(const std::string& name, int steps) const {
    GrowingMap grown;
    grown.grow_to(steps);
    save_map(folder_ / name, grown.map);
    return folder_ / name;
  }
  fs::path out() const { return folder_ / "out"; }
  fs::path map() const { return folder_ / "wall.map"; }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(MapCommand, ARunKeepsItsMapAndTheNextGoesOnWithIt) {
  ASSERT_EQ(call(run_arguments({"--map", map()})), 0) << stderr_;
  const auto summary = nlohmann::json::parse(content(out() / "summary.json"));
  EXPECT_EQ(summary.at("options").at("map"), map().string());
  const auto first = info(map());
  EXPECT_GT(first.at("landmarks"), 100);
  EXPECT_EQ(first.at("landmarks"), summary.at("landmarks"));
  EXPECT_EQ(first.at("keyframes"), summary.at("keyframes"));
  EXPECT_EQ(first.at("maps").size(), 1U);
  EXPECT_EQ(first.at("camera").at("fx"), 500.0);
  EXPECT_EQ(first.at("bytes"), fs::file_size(map()));
  EXPECT_NEAR(first.at("maps")[0].at("first_timestamp"), 10.0, 1e-6);

  ASSERT_EQ(call(run_arguments({"--map", map()})), 0) << stderr_;
  EXPECT_THAT(stderr_, HasSubstr(fmt::format("{}: {} keyframes", map().string(),
                                             first.at("keyframes").get<int>())));
  const auto second = info(map());
  EXPECT_GE(second.at("keyframes"), first.at("keyframes"));
  EXPECT_FALSE(fs::exists(map().string() + "-wal"));
}

TEST_F(MapCommand, AFileThatHasGivenManyIdsGetsNewOnes) {
  ASSERT_EQ(call(run_arguments({"--map", map()})), 0) << stderr_;
  {
    sqlite::Database database(map(), sqlite::Access::exclusive);
    database.run("UPDATE meta SET value = 1000000000 WHERE key = 'landmark_ids'");
  }
  ASSERT_EQ(call(run_arguments({"--localize", map()})), 0) << stderr_;
  EXPECT_GE(read_map(map()).map.landmark_ids(), 1'000'000'000) << "only looked at";
  ASSERT_EQ(call(run_arguments({"--map", map()})), 0) << stderr_;
  const Map after = read_map(map()).map;
  EXPECT_LT(after.landmark_ids(), 100'000);
  EXPECT_GT(after.live_landmarks(), 100);
}

TEST_F(MapCommand, LocalizingLeavesTheFileAsItIs) {
  ASSERT_EQ(call(run_arguments({"--map", map()})), 0) << stderr_;
  const std::string before = content(map());
  call(run_arguments({"--localize", map()}));
  EXPECT_EQ(content(map()), before);
  EXPECT_FALSE(fs::exists(map().string() + "-wal"));
}

TEST_F(MapCommand, ARunIsRefusedAMapItCannotUse) {
  const auto expect_refused = [&](const std::string& option, const std::string& why) {
    fs::remove_all(out());
    EXPECT_EQ(call(run_arguments({option, map()})), 1);
    EXPECT_THAT(stderr_, HasSubstr(map().string() + ": "));
    EXPECT_THAT(stderr_, HasSubstr(why));
    EXPECT_FALSE(fs::exists(out()));
  };
  expect_refused("--localize", "no such map file");
  EXPECT_FALSE(fs::exists(map()));
  std::ofstream(map()) << "notes of mine";
  for (const char* option : {"--map", "--localize"}) {
    expect_refused(option, "is no map file of dkp-slam");
    EXPECT_EQ(content(map()), "notes of mine");
  }
  fs::remove(map());
  saved("wall.map", 3);
  const std::string before = content(map());
  expect_refused("--map", "made with another camera: distortion k1 is 0.1 there and 0 here");
  EXPECT_EQ(content(map()), before);
  EXPECT_EQ(call(run_arguments({"--map", folder_ / "none/wall.map"})), 1);
  EXPECT_THAT(stderr_, HasSubstr("none does not exist"));
  EXPECT_EQ(call(run_arguments({"--map", map(), "--localize", map()})), 2);
}

TEST_F(MapCommand, AKilledRunLeavesAMapThatOpens) {
  // Five minutes by the clock, so that the end surely comes in the middle.
  run_arguments({});
  sequence_->prolong([](int i) { return i % frame_count; });
  for (const auto life : {1500ms, 2300ms}) {
    const Program program = start(run_arguments({"--realtime", "--map", map()}));
    program.wait_for("run: 1 of");
    std::this_thread::sleep_for(life);
    program.kill();
    ASSERT_EQ(program.wait(), 1000 + SIGKILL);
    EXPECT_GT(info(map()).at("keyframes"), 0);
  }
}

TEST_F(MapCommand, InfoToRead) {
  const fs::path file = saved("room.map", 30);
  ASSERT_EQ(call({"map", "info", file}), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("format 1, written by dkp-slam 0.1.0"));
  EXPECT_THAT(stdout_, HasSubstr("camera test: 640 x 480 pixels, fx 500 fy 500"));
  EXPECT_THAT(stdout_, HasSubstr("2 maps, "));
  EXPECT_THAT(stdout_, HasSubstr("  map 0: "));
  EXPECT_EQ(stderr_, "");
  const auto json = info(file);
  const int keyframes =
      json.at("maps")[0].at("keyframes").get<int>() + json.at("maps")[1].at("keyframes").get<int>();
  EXPECT_EQ(json.at("keyframes"), keyframes);
  EXPECT_EQ(call({"map", "info", folder_ / "other.map"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("no such map file"));
  EXPECT_EQ(call({"map"}), 2);
  EXPECT_EQ(call({"map", "info"}), 2);
}

TEST_F(MapCommand, ExportsPointsAndKeyframes) {
  const fs::path file = saved("room.map", 30);
  const Map map = read_map(file).map;
  ASSERT_EQ(call({"map", "export", file, "--out", out()}), 0) << stderr_;
  std::ifstream ply(out() / "landmarks.ply");
  std::string line;
  std::vector<std::string> header;
  while (std::getline(ply, line) && line != "end_header") header.push_back(line);
  EXPECT_THAT(header, ::testing::Contains(fmt::format("element vertex {}", map.live_landmarks())));
  Eigen::Vector3d point, first = Eigen::Vector3d::Zero();
  int id = -1, points = 0, in_second = 0;
  while (ply >> point.x() >> point.y() >> point.z() >> id) {
    if (points++ == 0) first = point;
    in_second += id == 1;
  }
  EXPECT_EQ(points, map.live_landmarks());
  EXPECT_EQ(in_second, int(map.landmarks_of(map.keyframes_in(1)).size()));
  EXPECT_LT((first - map.landmark(map.landmarks_of(map.keyframes_in(0)).front()).position).norm(),
            1e-5);
  for (int m = 0; m < 2; ++m) {
    const Trajectory path = read_trajectory(out() / fmt::format("keyframes_{}.txt", m));
    ASSERT_EQ(path.size(), map.keyframes_in(m).size());
    const Keyframe& k = map.keyframe(map.keyframes_in(m).front());
    EXPECT_LT(
        (path.front().world_from_camera.translation - k.camera_from_world.inverse().translation)
            .norm(),
        1e-6);
  }
}

TEST_F(MapCommand, MergesTwoFilesIntoAThird) {
  const fs::path a = saved("a.map", 15), b = saved("b.map", 25), c = folder_ / "c.map";
  const std::string bytes_a = content(a), bytes_b = content(b);
  ASSERT_EQ(call({"map", "merge", a, b, "--out", c}), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("3 maps, "));
  const auto in_a = info(a), in_b = info(b), in_c = info(c);
  EXPECT_EQ(in_c.at("keyframes").get<int>(),
            in_a.at("keyframes").get<int>() + in_b.at("keyframes").get<int>());
  EXPECT_EQ(in_c.at("landmarks").get<int>(),
            in_a.at("landmarks").get<int>() + in_b.at("landmarks").get<int>());
  EXPECT_EQ(content(a), bytes_a);
  EXPECT_EQ(content(b), bytes_b);
  const std::string bytes_c = content(c);
  EXPECT_EQ(call({"map", "merge", a, b, "--out", c}), 1);
  EXPECT_THAT(stderr_, HasSubstr("is there already"));
  EXPECT_EQ(content(c), bytes_c);
}

}  // namespace
}  // namespace dkp_slam

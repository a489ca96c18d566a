#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/sensor/stream/test_driver.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::DriverConnection;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t pixels = std::size_t{640} * 480;
constexpr std::size_t frame_bytes = 8 + 16 + pixels * 5;

/// Frame streams through real pipes and sockets into the program itself.
class StreamCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
  }
  fs::path out() const { return folder_ / "out"; }
  std::string socket() const { return "unix:" + (folder_ / "s").string(); }
  std::string path() const { return content(out() / "trajectory.txt"); }
  /// What the folder itself leads to.
  std::string path_of_folder() const {
    EXPECT_EQ(bash("$P run sequence --mode off --out folder 2>err"), 0) << err();
    return content(folder_ / "folder" / "trajectory.txt");
  }
  /// The sequence as a stream.
  std::string recorded() const {
    EXPECT_EQ(bash("$P stream sequence >sequence.stream 2>err"), 0) << err();
    return content(folder_ / "sequence.stream");
  }
  /// Where the i-th frame's record begins.
  static std::size_t begin_of(const std::string& stream, int i) {
    return stream.size() - 8 - (frame_count - static_cast<std::size_t>(i)) * frame_bytes;
  }
  /// Reads this stream from a pipe; messages are then in `err`.
  int run_on(const std::string& stream) const {
    std::ofstream(folder_ / "spoilt.stream", std::ios::binary) << stream;
    fs::remove_all(out());
    return bash("cat spoilt.stream | $P run - --mode off --out out >/dev/null 2>err");
  }
  /// Lines of the messages that are neither of some level nor progress.
  std::vector<std::string> error_lines() const {
    std::vector<std::string> lines;
    std::istringstream stream(err());
    for (std::string line; std::getline(stream, line);) {
      const bool message = line.find(": info: ") != std::string::npos ||
                           line.find(": warning: ") != std::string::npos ||
                           line.starts_with("run: ");
      if (!message) lines.push_back(line);
    }
    return lines;
  }
  void expect_refused(const std::string& stream, const std::string& why) const {
    EXPECT_EQ(run_on(stream), 1);
    EXPECT_THAT(error_lines(), ::testing::ElementsAre(HasSubstr(why)));
    EXPECT_FALSE(fs::exists(out()));
  }
  /// The run ended early, said why in one line, and kept this many frames' poses.
  void expect_cut(const std::string& stream, const std::string& why, std::size_t frames) const {
    EXPECT_EQ(run_on(stream), 1);
    EXPECT_THAT(error_lines(), ::testing::ElementsAre(HasSubstr(why)));
    EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), frames);
    EXPECT_TRUE(fs::exists(out() / "summary.json"));
  }
  Program start(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"run", "--source", socket(), "--mode",
                                          "off", "--out",    out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return CommandTest::start(arguments);
  }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(StreamCommand, APipeLeadsToTheSamePathAsTheFolderToTheByte) {
  // Depth images of another moment than colour: that goes along, too.
  std::string depths = content(folder_ / "sequence/depth.txt");
  for (std::size_t at = 0; (at = depths.find("\n10.", at)) != std::string::npos; at += 4) {
    depths[at + 9] = depths[at + 9] == '9' ? '8' : '9';
  }
  std::ofstream(folder_ / "sequence/depth.txt") << depths;
  const std::string expected = path_of_folder();
  ASSERT_EQ(bash("$P stream sequence 2>/dev/null | $P run - --mode off --out out 2>err"), 0)
      << err();
  EXPECT_EQ(path(), expected);
  recorded();
  ASSERT_EQ(bash("$P run - --mode off --camera sequence/camera.yaml --out out "
                 "<sequence.stream 2>err"),
            0);
  EXPECT_EQ(path(), expected);
  const auto summary = nlohmann::json::parse(content(out() / "summary.json"));
  EXPECT_EQ(summary.at("options").at("sequence"), "-");
  EXPECT_EQ(summary.at("options").at("realtime"), false);
}

TEST_F(StreamCommand, ASocketOfflineLeadsToTheSamePath) {
  const std::string expected = path_of_folder();
  const Program program = start({"--offline"});
  ASSERT_EQ(bash(fmt::format("$P stream sequence --to {} 2>err", socket())), 0) << err();
  EXPECT_EQ(program.wait(), 0) << program.err();
  EXPECT_EQ(path(), expected);
}

TEST_F(StreamCommand, ASocketIsALiveCamera) {
  const Program program = start({});
  ASSERT_EQ(bash(fmt::format("$P stream sequence --realtime --to {} 2>err", socket())), 0);
  program.wait();
  const auto summary = nlohmann::json::parse(content(out() / "summary.json"));
  EXPECT_EQ(summary.at("options").at("realtime"), true);
  EXPECT_EQ(summary.at("options").at("rate"), nullptr);
  EXPECT_EQ(summary.at("frames").get<int>() + summary.at("dropped_frames").get<int>(), frame_count);
}

TEST_F(StreamCommand, ADriverThatIsCutOffMayComeBackToTheSamePath) {
  const std::string expected = path_of_folder(), stream = recorded();
  const std::size_t half = begin_of(stream, 5) + frame_bytes / 2;
  const std::string header = stream.substr(0, begin_of(stream, 0));
  const Program program = start({"--offline"});
  DriverConnection(socket()).send(stream.substr(0, half));
  DriverConnection(socket()).send(header + stream.substr(begin_of(stream, 5)));
  EXPECT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(program.err(), AllOf(HasSubstr("cut off in the middle of frame 5"),
                                   HasSubstr("a driver is there again")));
  EXPECT_EQ(path(), expected);
}

TEST_F(StreamCommand, ADriverThatStaysAwayLeavesWhatThereIs) {
  const std::string stream = recorded();
  const Program program = start({"--reconnect", "0.1"});
  DriverConnection(socket()).send(stream.substr(0, begin_of(stream, 5)));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.err(), HasSubstr("no driver came back within 0.1 s"));
  EXPECT_TRUE(fs::exists(out() / "summary.json"));
  EXPECT_FALSE(fs::exists(folder_ / "s"));
}

TEST_F(StreamCommand, CtrlCEndsTheWaitForADriverAndForOneThatHangs) {
  {
    const Program program = start({});
    program.wait_for("waiting for a driver at unix:");
    program.interrupt();
    EXPECT_EQ(program.wait(), 130);
    EXPECT_FALSE(fs::exists(out()));
  }
  const std::string stream = recorded();
  const Program program = start({"--offline"});
  DriverConnection hanging(socket());
  hanging.send(stream.substr(0, begin_of(stream, 3) + 100));
  program.wait_for("no detector runs");
  program.interrupt();
  EXPECT_EQ(program.wait(), 130);
  EXPECT_TRUE(fs::exists(out() / "summary.json"));
  EXPECT_FALSE(fs::exists(folder_ / "s"));
}

TEST_F(StreamCommand, WhatIsNoStreamIsRefusedBeforeAnythingIsWritten) {
  const std::string stream = recorded();
  expect_refused("", "standard input: cut off in the middle of the header (0 of 40 bytes came)");
  expect_refused(content(folder_ / "sequence/rgb.txt"), "is no frame stream: it begins with bytes");
  expect_refused(stream.substr(0, 100), "cut off in the middle of the camera file");
  std::string larger = stream;
  larger[15] = '\x7F';  // the width's highest byte
  expect_refused(larger, "pixels; give width and height");
  EXPECT_EQ(bash("$P run - --mode off --camera fr1 --out out </dev/null 2>err"), 1);
  EXPECT_EQ(bash("$P run --out out 2>err"), 2);
  EXPECT_EQ(bash("$P run --source tcp:0 --rate 2 --realtime --out out 2>err"), 2);
  EXPECT_EQ(bash("$P run --source tcp:x --mode off --out out 2>err"), 1);
  EXPECT_THAT(err(), HasSubstr("tcp:x: is no address of a stream"));
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(StreamCommand, WhatIsSpoiltInTheMiddleKeepsWhatCameBefore) {
  const std::string stream = recorded();
  expect_cut(stream.substr(0, begin_of(stream, 8)), "cut off after 8 frames, without the end", 8);
  expect_cut(stream.substr(0, begin_of(stream, 9) - 1), "cut off in the middle of frame 8", 8);
  std::string tag = stream, length = stream, stamp = stream;
  tag[begin_of(stream, 6)] = 'X';
  expect_cut(tag, "after frame 5: bytes 58524d45", 6);
  length[begin_of(stream, 6) + 4] ^= 1;
  expect_cut(length, "after frame 5: a frame of 1536017 bytes, where 640 x 480", 6);
  for (std::size_t i = 0; i < 8; ++i) stamp[begin_of(stream, 6) + 8 + i] = '\xFF';
  expect_cut(stamp, "frame 6: its time stamp or depth delay is no number", 6);
}

TEST_F(StreamCommand, StampsThatGoBackAreSaidAndCounted) {
  std::string stream = recorded();
  std::copy_n(stream.begin() + static_cast<std::ptrdiff_t>(begin_of(stream, 2)) + 8, 8,
              stream.begin() + static_cast<std::ptrdiff_t>(begin_of(stream, 6)) + 8);
  EXPECT_EQ(run_on(stream), 0) << err();
  EXPECT_THAT(err(), HasSubstr("frame 6: its time stamp 10.066667 is not after"));
  EXPECT_EQ(nlohmann::json::parse(content(out() / "summary.json")).at("skipped_frames"), 1);
}

TEST_F(StreamCommand, MasksComeWithTheStream) {
  fs::create_directory(folder_ / "masks");
  for (int i = 0; i < frame_count; ++i) {
    cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(0));
    mask.colRange(0, 200).setTo(1);
    write_image(folder_ / "masks" / (WallSequence::stamp(i) + ".png"), mask);
  }
  ASSERT_EQ(bash("$P run sequence --masks masks --out folder 2>err"), 0) << err();
  ASSERT_EQ(bash("$P stream sequence --masks masks 2>/dev/null | "
                 "$P run - --mode masks --out out 2>err"),
            0)
      << err();
  EXPECT_EQ(path(), content(folder_ / "folder/trajectory.txt"));
  EXPECT_EQ(bash("$P run - --masks masks --out out </dev/null 2>err"), 2);
}

TEST_F(StreamCommand, APlayerSaysWhatKeepsItFromPlaying) {
  EXPECT_EQ(bash(fmt::format("$P stream sequence --to {} --wait 0 2>err", socket())), 1);
  EXPECT_THAT(err(), HasSubstr("nobody listens there: No such file"));
  EXPECT_EQ(bash("$P stream sequence 2>err | true"), 1);
  EXPECT_THAT(err(), HasSubstr("standard output: the reader has gone away"));
  EXPECT_EQ(bash("$P stream sequence >/dev/full 2>err"), 1);
  EXPECT_THAT(err(), HasSubstr("standard output: No space left on device"));
}

TEST_F(StreamCommand, TheExampleDriverIsUnderstood) {
  if (bash("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
    GTEST_SKIP() << "needs Debian's python3-numpy";
  }
  const std::string driver = "/usr/bin/python3 " DKP_SLAM_EXAMPLES "/stream/driver.py";
  ASSERT_EQ(bash(driver + " | $P run - --mode off --out out 2>err"), 0) << err();
  const Trajectory path = read_trajectory(out() / "trajectory.txt");
  ASSERT_EQ(path.size(), 30U);
  // Three pixels of 500 a frame at two metres.
  EXPECT_NEAR(path.back().world_from_camera.translation.x(), 29 * 3 * 2.0 / 500.0, 0.002);
  const Program program = start({"--offline"});
  program.wait_for("waiting for a driver");
  EXPECT_EQ(bash(fmt::format("{} s 2>err", driver)), 0) << err();
  EXPECT_EQ(program.wait(), 0) << program.err();
}

}  // namespace
}  // namespace dkp_slam

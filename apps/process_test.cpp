#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include "apps/test_program.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;
using ::testing::Not;

/// The program started in ways that no user means, but shells, services and robots do.
class OddStart : public testing::FolderTest {
 protected:
  fs::path out() const { return folder_ / "out"; }
  /// As a command line for a shell.
  std::string run_text(const fs::path& sequence, const std::string& more = "") const {
    return fmt::format("HOME='{}' '{}' run '{}' --camera '{}' --mode off --out '{}' {}",
                       folder_.string(), DKP_SLAM_PROGRAM, sequence.string(),
                       (sequence / "camera.yaml").string(), out().string(), more);
  }
  /// Exit code of a command line of bash; 1000 and more when a signal ended it.
  int bash(const std::string& line) const {
    const fs::path script = folder_ / "line.sh";
    std::ofstream(script) << line << '\n';
    const int status = std::system(fmt::format("bash '{}'", script.string()).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  void expect_whole_run() const {
    EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), frame_count);
    std::ifstream timings(out() / "timings.csv");
    std::string header, line;
    std::getline(timings, header);
    int lines = 0;
    for (; std::getline(timings, line); ++lines) {
      EXPECT_EQ(std::count(line.begin(), line.end(), ','),
                std::count(header.begin(), header.end(), ','))
          << line;
    }
    EXPECT_EQ(lines, frame_count);
  }
};

TEST_F(OddStart, MessagesThatCannotBeWrittenEndNothing) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  EXPECT_EQ(bash(run_text(sequence.folder(), "2>/dev/full")), 0);
  expect_whole_run();
}

TEST_F(OddStart, WhatWasAskedForAndCannotBeWrittenIsAFailure) {
  const fs::path err = folder_ / "err";
  for (const char* command : {"config", "help robot", "completion bash", "man"}) {
    const std::string line = fmt::format("HOME='{}' '{}' {} >/dev/full 2>'{}'", folder_.string(),
                                         DKP_SLAM_PROGRAM, command, err.string());
    EXPECT_EQ(bash(line), 1) << command;
    EXPECT_THAT(content(err), HasSubstr("cannot write to the standard output")) << command;
  }
}

TEST_F(OddStart, ClosedDescriptorsTakeNoMessageIntoAFile) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  for (const char* closed : {"2>&-", ">&-", "<&- >&- 2>&-"}) {
    fs::remove_all(out());
    EXPECT_EQ(bash(run_text(sequence.folder(), closed)), 0) << closed;
    expect_whole_run();
  }
}

TEST_F(OddStart, AReaderThatGoesAwayEndsNothing) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  EXPECT_EQ(bash(run_text(sequence.folder(), "2>&1 >/dev/null | true; exit ${PIPESTATUS[0]}")), 0);
  expect_whole_run();
}

TEST_F(OddStart, ALimitOnTheSizeOfFilesIsAnErrorAndLeavesNoFileHalfWritten) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  EXPECT_EQ(bash(fmt::format("(ulimit -f 1; {}) 2>&1 | cat >'{}'; exit ${{PIPESTATUS[0]}}",
                             run_text(sequence.folder()), (folder_ / "err").string())),
            1);
  EXPECT_THAT(content(folder_ / "err"), HasSubstr("cannot write"));
  for (const auto& entry : fs::directory_iterator(out())) {
    if (entry.path().filename() == "trajectory.txt") {
      EXPECT_EQ(read_trajectory(entry).size(), frame_count);
    }
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    EXPECT_NE(entry.path().filename(), "summary.json");
  }
}

TEST_F(OddStart, LinksInACircleAreSaidInOneLine) {
  const fs::path loop = folder_ / "loop", err = folder_ / "err";
  fs::create_symlink(loop, loop);
  const WallSequence sequence(folder_ / "sequence", frame_count);
  const std::string options[] = {
      run_text(loop), run_text(sequence.folder(), fmt::format("--map '{}'", loop.string()))};
  for (const std::string& line : options) {
    EXPECT_EQ(bash(fmt::format("{} 2>'{}'", line, err.string())), 1) << line;
    EXPECT_THAT(content(err), HasSubstr("Too many levels of symbolic links")) << line;
    EXPECT_THAT(content(err), Not(HasSubstr("filesystem error"))) << line;
    EXPECT_FALSE(fs::exists(out())) << line;
  }
}

TEST_F(OddStart, PathsThatAreNoUtf8StandInEveryFile) {
  const WallSequence sequence(folder_ / "s\xFFquence", frame_count);
  const fs::path map = folder_ / "m\xFFp";
  EXPECT_EQ(bash(run_text(sequence.folder(), fmt::format("--map '{}'", map.string()))), 0);
  expect_whole_run();
  EXPECT_EQ(nlohmann::json::parse(content(out() / "summary.json")).at("frames"), frame_count);
  const fs::path described = folder_ / "map.json";
  EXPECT_EQ(bash(fmt::format("'{}' map info '{}' --json >'{}'", DKP_SLAM_PROGRAM, map.string(),
                             described.string())),
            0);
  EXPECT_TRUE(nlohmann::json::parse(content(described)).is_object());
}

TEST_F(OddStart, ATerminalObeysNoFileName) {
  const fs::path err = folder_ / "err";
  for (const char* line : {"run 'x\x1B[31mx' --camera fr1 --out o", "run 'x\x1B[31mx'"}) {
    EXPECT_NE(bash(fmt::format("cd '{}'; '{}' {} 2>err", folder_.string(), DKP_SLAM_PROGRAM, line)),
              0);
    EXPECT_THAT(content(err), Not(HasSubstr("\x1B"))) << line;
  }
}

TEST_F(OddStart, ATerminalObeysNoWarning) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  const fs::path err = folder_ / "err";
  // Colours, by the escape character and by its sibling of eight bits.
  std::ofstream(sequence.folder() / "rgb.txt", std::ios::app)
      << "20.0 rgb/\x1B[31mx.png\n20.1 rgb/\xC2\x9B"
         "31mx.png\n";
  std::ofstream(sequence.folder() / "depth.txt", std::ios::app)
      << "20.0 depth/x.png\n20.1 depth/x.png\n";
  EXPECT_EQ(bash(run_text(sequence.folder(), fmt::format("2>'{}'", err.string()))), 0);
  const std::string said = content(err);
  EXPECT_THAT(said, HasSubstr("rgb/?[31mx.png"));
  EXPECT_THAT(said, Not(HasSubstr("\x1B")));
  EXPECT_THAT(said, Not(HasSubstr("\xC2\x9B")));
}

TEST_F(OddStart, ATerminalThatGoesAwayLeavesWhatThereIs) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  sequence.prolong([](int) { return frame_count - 1; });
  const Program program(
      folder_, {"run", sequence.folder(), "--mode", "off", "--realtime", "--out", out()}, {});
  program.wait_for("run: 1 of");
  program.hang_up();
  EXPECT_EQ(program.wait(), 130);
  EXPECT_FALSE(read_trajectory(out() / "trajectory.txt").empty());
}

TEST_F(OddStart, ASignalBeforeTheFirstFrameIsNoDeathBySignal) {
  const WallSequence sequence(folder_ / "sequence", frame_count);
  const fs::path config = folder_ / "config.yaml";
  ASSERT_EQ(mkfifo(config.c_str(), 0600), 0);
  const Program program(
      folder_, {"run", sequence.folder(), "--config", config, "--mode", "off", "--out", out()}, {});
  std::ofstream pipe(config);  // waits until the program reads it
  program.interrupt();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  pipe << "seed: 7\n";
  pipe.close();
  EXPECT_EQ(program.wait(), 130);
  EXPECT_THAT(program.err(), HasSubstr("interrupted after 0 frames"));
  EXPECT_TRUE(fs::exists(out() / "summary.json"));
}

}  // namespace
}  // namespace dkp_slam

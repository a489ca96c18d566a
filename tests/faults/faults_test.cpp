// Faults of the disk and the memory, kills and signals: the program ends with a code and a line,
// and what it leaves is whole. DKP_SLAM_FAULTS=full plays every call in turn until none is reached,
// and 50 random moments; else a few of them.

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include "apps/test_program.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr int frame_count = 6;
constexpr int killed = 1000;  // and the signal's number: Program::wait

bool full() {
  const char* wanted = std::getenv("DKP_SLAM_FAULTS");
  return wanted && std::string(wanted) == "full";
}

/// Memory ran out where a library could not go on: what lies on the disk is as after a kill.
bool ended_at_once(int code, const std::string& said) {
  return code >= killed || said.find("a library cannot go on") != std::string::npos;
}

/// A call to fail, as the shim takes it.
struct Fault {
  const char* call;
  const char* error;
  bool lasts = false;
};

class Faults : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
    disk_ = folder_;
  }

  fs::path out() const { return disk_ / "out"; }
  fs::path map() const { return disk_ / "room.map"; }
  std::vector<std::string> run_arguments() const {
    return {"run", sequence_->folder(), "--mode", "off", "--out", out(), "--map", map()};
  }
  std::vector<std::string> environment() const { return {"HOME=" + folder_.string()}; }
  void clear() const {
    fs::remove_all(out());
    for (const char* suffix : {"", "-wal"}) fs::remove(map().string() + suffix);
  }

  /// Files that are there can be read, and nothing is left of those that are not.
  void expect_whole(int code, const std::string& said) const {
    // Of a run that found no pose it has none.
    const std::string path = content(out() / "trajectory.txt");
    if (path.find("\n1") != std::string::npos) {
      EXPECT_NO_THROW(read_trajectory(out() / "trajectory.txt"));
      EXPECT_EQ(path.back(), '\n');
    }
    if (fs::exists(out() / "summary.json")) {
      EXPECT_TRUE(nlohmann::json::parse(content(out() / "summary.json")).is_object());
    }
    if (fs::exists(map())) {
      EXPECT_NO_THROW(read_map(map()));
    }
    if (fs::exists(out())) expect_no_remains(out());
    if (!ended_at_once(code, said)) expect_no_remains(disk_);
    if (code == 0) {
      EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), frame_count);
      EXPECT_TRUE(fs::exists(out() / "summary.json"));
      EXPECT_TRUE(fs::exists(map()));
    }
  }
  static void expect_no_remains(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    }
  }

  /// Runs the program with its n-th such call failing. False when it made fewer.
  bool play(const Fault& fault, long nth) const {
    const fs::path seen = folder_ / "seen";
    fs::remove(seen);
    clear();
    std::vector<std::string> with = environment();
    with.insert(
        with.end(),
        {std::string("LD_PRELOAD=") + DKP_SLAM_FAULT_SHIM, std::string("FAULT_CALL=") + fault.call,
         std::string("FAULT_ERROR=") + fault.error, fmt::format("FAULT_NTH={}", nth),
         fmt::format("FAULT_LASTS={:d}", fault.lasts), "FAULT_SEEN=" + seen.string()});
    const Program program(folder_, run_arguments(), with);
    const int code = program.wait();
    SCOPED_TRACE(fmt::format("{} {} {} of {}: exit code {}: {}", fault.call, fault.error,
                             fault.lasts ? "from" : "only", nth, code, program.err()));
    EXPECT_TRUE(code == 0 || code == 1);
    if (code == 1) {
      EXPECT_THAT(program.err(), HasSubstr("dkp-slam: "));
    }
    expect_whole(code, program.err());
    return fs::exists(seen);
  }
  /// Every call in turn, or a few of them: the first, and then so many times as far on.
  void play_all(const Fault& fault, long first, double factor) const {
    long nth = first;
    while (play(fault, nth)) nth = full() ? nth + 1 : std::max(nth + 1, std::lround(factor * nth));
    EXPECT_GT(nth, first) << "no such call was made";
  }

  std::unique_ptr<WallSequence> sequence_;
  fs::path disk_;  ///< where results go
};

TEST_F(Faults, ADiskThatIsFullForOnceOrForAll) {
  play_all({"write", "enospc"}, 1, 8.0);
  play_all({"write", "enospc", true}, 2, 8.0);
}

TEST_F(Faults, ADiskThatFails) {
  play_all({"write", "eio", true}, 4, 8.0);
  play_all({"sync", "eio", true}, 1, 8.0);
  play_all({"open", "eio", true}, 1, 8.0);
  play_all({"open", "eio"}, 3, 8.0);
}

TEST_F(Faults, WritesThatAreCutShort) { play_all({"write", "short", true}, 1, 12.0); }

TEST_F(Faults, ReadsThatFailOrAreCutShort) {
  play_all({"read", "eio"}, 1, 12.0);
  play_all({"read", "short", true}, 1, 24.0);
}

TEST_F(Faults, FilesThatMayNotGrow) {
  for (const rlim_t bytes : {100UL, 20'000UL, 100'000UL}) {
    clear();
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit limit{bytes, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    const Program program(folder_, run_arguments(), environment());
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    const int code = program.wait();
    SCOPED_TRACE(fmt::format("{} bytes: exit code {}: {}", bytes, code, program.err()));
    EXPECT_EQ(code, 1);
    expect_whole(code, program.err());
  }
}

TEST_F(Faults, AKillAtAnyMoment) {
  std::mt19937 random(1);
  for (int i = 0; i < (full() ? 50 : 2); ++i) {
    clear();
    const Program program(folder_, run_arguments(), environment());
    std::this_thread::sleep_for(std::chrono::milliseconds(50 + random() % 600));
    program.kill();
    const int code = program.wait();
    SCOPED_TRACE(fmt::format("kill {}: exit code {}", i, code));
    expect_whole(code, program.err());
    // The next one goes on where that one was.
    const Program again(folder_, run_arguments(), environment());
    EXPECT_EQ(again.wait(), 0) << again.err();
  }
}

TEST_F(Faults, ASignalAtAnyMomentOfAnyCommand) {
  const Program before(folder_, run_arguments(), environment());
  ASSERT_EQ(before.wait(), 0) << before.err();
  const fs::path kept = folder_ / "kept.map", copy = folder_ / "copy";
  fs::rename(map(), kept);
  const std::vector<std::string> commands[] = {
      run_arguments(),
      {"record", sequence_->folder(), "--out", copy},
      {"map", "merge", kept, kept, "--out", folder_ / "merged.map"},
      {"synth", "static_room", "--frames", "5", "--width", "160", "--height", "120", "--out", copy},
      {"eval", sequence_->folder() / "groundtruth.txt", sequence_->folder() / "groundtruth.txt"}};
  std::mt19937 random(2);
  for (int i = 0; i < (full() ? 100 : 5); ++i) {
    clear();
    fs::remove_all(copy);
    fs::remove(folder_ / "merged.map");
    const std::vector<std::string>& command = commands[static_cast<std::size_t>(i) % 5];
    const Program program(folder_, command, environment());
    std::this_thread::sleep_for(std::chrono::milliseconds(1 + random() % 400));
    program.interrupt();
    const int code = program.wait();
    SCOPED_TRACE(fmt::format("{} {}: exit code {}: {}", i, command.front(), code, program.err()));
    // Before the program has begun, and in commands that are done in a moment, a signal is the
    // system's.
    EXPECT_TRUE(code == 0 || code == 130 || code == killed + SIGINT);
    if (fs::exists(folder_ / "merged.map")) {
      EXPECT_NO_THROW(read_map(folder_ / "merged.map"));
    }
    if (code < killed) expect_no_remains(folder_);
    if (command.front() == "run" && code == 0) expect_whole(code, "");
  }
}

TEST_F(Faults, MemoryThatRunsOutOnceOnEveryWayThroughTheProgram) {
  play_all({"place", "enomem"}, 2, 5.0);
}

TEST_F(Faults, MemoryThatRunsOutForGood) {
  if (!full()) return play_all({"memory", "enomem", true}, 2000, 8.0);
  std::mt19937 random(4);
  constexpr long calls = 300'000;
  for (int i = 0; i < 300; ++i)
    play({"memory", "enomem", true}, 1 + static_cast<long>(random() % calls));
}

TEST_F(Faults, MemoryThatRunsOutForOnce) {
  if (!full()) return play_all({"memory", "enomem"}, 3, 6.0);
  // There are hundreds of thousands: at random, as often as takes some minutes.
  std::mt19937 random(3);
  constexpr long calls = 300'000;
  for (int i = 0; i < 500; ++i) play({"memory", "enomem"}, 1 + static_cast<long>(random() % calls));
}

TEST_F(Faults, MemoryThatIsLimited) {
  const int step = full() ? 10 : 160;  // MB
  int failed = 0;
  // From where the libraries fit but not the threads to where all fits.
  for (int megabytes = 190; megabytes < 1000; megabytes += step) {
    clear();
    const int status =
        std::system(fmt::format("ulimit -v {}; HOME='{}' '{}' '{}' >'{}' 2>&1", megabytes * 1000,
                                folder_.string(), DKP_SLAM_PROGRAM,
                                fmt::join(run_arguments(), "' '"), (folder_ / "said").string())
                        .c_str());
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : killed + WTERMSIG(status);
    constexpr int not_loaded = 127;  // what the system says where its libraries do not fit
    SCOPED_TRACE(fmt::format("{} MB: {}: {}", megabytes, code, content(folder_ / "said")));
    EXPECT_TRUE(code == 0 || code == 1 || code == not_loaded);
    expect_whole(code, content(folder_ / "said"));
    failed += code == 1;
  }
  EXPECT_GT(failed, 0) << "memory was enough for all";
}

/// A disk of its own that is really full, where the test may make one.
class FullDisk : public Faults {
 protected:
  void SetUp() override {
    Faults::SetUp();
    const fs::path disk = folder_ / "disk";
    fs::create_directories(disk);
    mounted_ = mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=4k") == 0;
    if (!mounted_) {
      GTEST_SKIP() << "no small disk can be made here (mount tmpfs: " << std::strerror(errno)
                   << "); root may";
    }
    disk_ = disk;
  }
  void TearDown() override {
    if (mounted_) umount2(disk_.c_str(), MNT_DETACH);
    Faults::TearDown();
  }
  void resize(int kilobytes) const {
    ASSERT_EQ(mount("tmpfs", disk_.c_str(), "tmpfs", MS_REMOUNT,
                    fmt::format("size={}k", kilobytes).c_str()),
              0)
        << std::strerror(errno);
  }

 private:
  bool mounted_ = false;
};

TEST_F(FullDisk, EndsTheRunWithALineAndItGoesOnOnceThereIsRoom) {
  const double step = full() ? 1.1 : 3.0;
  int failed = 0;
  for (double kilobytes = 4.0; kilobytes < 3000.0; kilobytes = step * kilobytes + 4.0) {
    clear();
    resize(static_cast<int>(kilobytes));
    const Program program(folder_, run_arguments(), environment());
    const int code = program.wait();
    SCOPED_TRACE(fmt::format("{:.0f} kB: exit code {}: {}", kilobytes, code, program.err()));
    EXPECT_TRUE(code == 0 || code == 1);
    expect_whole(code, program.err());
    if (code == 0) continue;
    ++failed;
    EXPECT_THAT(program.err(), ContainsRegex("No space left on device|disk is full"));
    resize(32 << 10);
    const Program again(folder_, run_arguments(), environment());
    EXPECT_EQ(again.wait(), 0) << again.err();
  }
  EXPECT_GT(failed, 0) << "there was room for all";
}

}  // namespace
}  // namespace dkp_slam

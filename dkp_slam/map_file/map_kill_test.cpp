#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/map_file/sqlite.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::content;
using testing::difference;
using testing::GrowingMap;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

/// A process that grows a map; see map_kill_child.cpp.
class Child {
 public:
  Child(const fs::path& folder, const std::vector<std::string>& more = {"60"})
      : file(folder / "room.map"), log_(folder / "steps.log"), error_(folder / "error.log") {
    fs::create_directories(folder);
    fs::remove(log_);
    std::vector<std::string> words{DKP_SLAM_MAP_KILL_CHILD, file, log_};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    char* environment[] = {nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, error_.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    EXPECT_EQ(posix_spawn(&id_, DKP_SLAM_MAP_KILL_CHILD, &actions, nullptr, arguments.data(),
                          environment),
              0);
    posix_spawn_file_actions_destroy(&actions);
  }

  void kill() {
    killed_ = Clock::now();
    ::kill(id_, SIGKILL);
    ASSERT_EQ(wait(), 1000 + SIGKILL) << error();
  }
  /// Exit code; 1000 and the signal's number when a signal ended it.
  int wait() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  std::string error() const { return content(error_); }
  /// Steps that were done at that moment.
  int steps_at(Clock::time_point moment) const {
    std::ifstream stream(log_);
    long long nanoseconds = 0;
    int steps = 0, last = 0;
    while (stream >> nanoseconds >> steps) {
      if (Clock::time_point(std::chrono::nanoseconds(nanoseconds)) <= moment) last = steps;
    }
    return last;
  }
  Clock::time_point killed() const { return killed_; }

  const fs::path file;

 private:
  fs::path log_, error_;
  pid_t id_ = 0;
  Clock::time_point killed_;
};

class Killing : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("map_kill_") + info->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The file holds the whole map of one moment, and reading leaves it and its log as they are.
  /// Returns the map's steps, 0 where there is no file yet.
  static int expect_sound(const fs::path& file) {
    if (!fs::exists(file)) return 0;
    const fs::path log = file.string() + "-wal";
    const bool has_log = fs::exists(log);
    const std::string before = content(file), log_before = content(log);
    if (has_log) {
      sqlite::Database database(file, sqlite::Access::read_with_log);
      sqlite::Statement check(database, "PRAGMA integrity_check");
      EXPECT_TRUE(check.step());
      EXPECT_EQ(check.text(0), "ok");
    }
    const StoredMap stored = read_map(file);
    EXPECT_TRUE(content(file) == before && content(log) == log_before);
    EXPECT_EQ(fs::exists(log), has_log);
    EXPECT_FALSE(fs::exists(file.string() + "-shm"));
    const int steps = GrowingMap::steps_of(stored.map);
    if (steps == 0) return 0;
    GrowingMap grown;
    grown.grow_to(steps);
    EXPECT_EQ(difference(grown.map, stored.map), "");
    return steps;
  }

  fs::path folder_;
};

TEST_F(Killing, AtFiftyMomentsLosesNothingOlderThanASecond) {
  constexpr int together = 10, rounds = 5;
  std::mt19937_64 random(2026);
  int grown_steps = 0, tested_steps = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::unique_ptr<Child>> children;
    std::vector<int> moments;  // ms
    for (int i = 0; i < together; ++i) {
      children.push_back(std::make_unique<Child>(folder_ / std::to_string(i)));
      moments.push_back(static_cast<int>(random() % 2600));
    }
    std::vector<std::size_t> order(children.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return moments[a] < moments[b]; });
    const auto start = Clock::now();
    for (const std::size_t i : order) {
      std::this_thread::sleep_until(start + std::chrono::milliseconds(moments[i]));
      children[i]->kill();
    }
    for (const std::size_t i : order) {
      SCOPED_TRACE(::testing::Message()
                   << "child " << i << " killed after " << moments[i] << " ms");
      const int saved = expect_sound(children[i]->file);
      const int before = children[i]->steps_at(children[i]->killed() - 1s);
      EXPECT_GE(saved, before);
      tested_steps += before > 0;
      grown_steps = std::max(grown_steps, saved);
    }
  }
#ifdef __SANITIZE_THREAD__
  if (tested_steps <= 10 || grown_steps <= 50) {
    GTEST_SKIP() << "all files are sound, but ThreadSanitizer made the children too slow to lose "
                    "much";
  }
#endif
  EXPECT_GT(tested_steps, 10);  // else the children were too slow to show anything
  EXPECT_GT(grown_steps, 50);
}

TEST_F(Killing, AFileInUseIsLeftAlone) {
  Child child(folder_, {"100000"});
  while (child.steps_at(Clock::now()) < 3) std::this_thread::sleep_for(10ms);
  try {
    read_map(child.file);
    ADD_FAILURE() << "was read";
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), HasSubstr("another process"));
  }
  child.kill();
  EXPECT_GT(expect_sound(child.file), 0);
}

TEST_F(Killing, AFullDiskIsSaidAndKeepsWhatWasSaved) {
  Child child(folder_, {"100000", "400000"});
  EXPECT_EQ(child.wait(), 1);
  const std::string error = child.error();
  EXPECT_THAT(error, HasSubstr((folder_ / "room.map").string()));
  EXPECT_THAT(error, HasSubstr("what was saved before is kept"));
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  EXPECT_GT(expect_sound(child.file), 5);
}

}  // namespace
}  // namespace dkp_slam

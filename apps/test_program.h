#pragma once

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/file_text.h"

namespace dkp_slam::testing {

/// The built program as a process of its own, its streams going to files in `folder`.
class Program {
 public:
  /// `environment`: NAME=VALUE, all that the process gets beside PATH.
  Program(const std::filesystem::path& folder, std::vector<std::string> arguments,
          std::vector<std::string> environment)
      : out_(folder / "stdout.log"), err_(folder / "stderr.log") {
    arguments.insert(arguments.begin(), DKP_SLAM_PROGRAM);
    // What says how to find programs, and what a sanitizer is to do with what it finds.
    for (const char* name :
         {"PATH", "ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"}) {
      if (const char* value = std::getenv(name))
        environment.push_back(std::string(name) + '=' + value);
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out_.c_str(), flags, 0644);
    posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), flags, 0644);
    const int failure = posix_spawn(&id_, DKP_SLAM_PROGRAM, &actions, nullptr,
                                    pointers(arguments).data(), pointers(environment).data());
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) throw std::runtime_error("cannot start " DKP_SLAM_PROGRAM);
  }

  /// Waits until its messages hold this, 20 s at most.
  void wait_for(const std::string& message) const {
    for (int i = 0; i < 1000 && err().find(message) == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  void interrupt() const { ::kill(id_, SIGINT); }
  void hang_up() const { ::kill(id_, SIGHUP); }
  void kill() const { ::kill(id_, SIGKILL); }
  /// Exit code; 1000 and the signal's number when a signal ended it. To be called once.
  int wait() const {
    int status = 0;
    ::waitpid(id_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  std::string out() const { return content(out_); }
  std::string err() const { return content(err_); }

 private:
  static constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  static std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> result;
    for (std::string& word : words) result.push_back(word.data());
    result.push_back(nullptr);
    return result;
  }

  std::filesystem::path out_, err_;
  pid_t id_ = 0;
};

}  // namespace dkp_slam::testing

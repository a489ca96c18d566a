#include "dkp_slam/evaluation/measure/child_process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/machine.h"

extern char** environ;  // NOLINT: POSIX gives it this way only

namespace dkp_slam {
namespace {

// Coarse enough to cost nothing, fine enough for a wall time in percent of a run of a second.
constexpr auto poll_interval = std::chrono::milliseconds(5);

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

pid_t spawn(const std::vector<std::string>& command, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t child = 0;
  const int failure =
      posix_spawn(&child, command.front().c_str(), &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (failure != 0) {
    throw Error(fmt::format("{}: cannot be started: {}; is it there, readable and executable?",
                            command.front(), std::strerror(failure)));
  }
  return child;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command, const std::filesystem::path& log,
                          const std::function<bool()>& stop) {
  using Clock = std::chrono::steady_clock;
  const std::optional<double> busy_before = busy_seconds();
  const Clock::time_point start = Clock::now();
  const pid_t child = spawn(command, log);
  int status = 0;
  rusage usage{};
  bool told = false;
  while (true) {
    const pid_t ended = wait4(child, &status, WNOHANG, &usage);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) {
      throw Error(fmt::format("{}: was lost: {}", command.front(), std::strerror(errno)));
    }
    if (!told && stop()) {
      kill(child, SIGINT);
      told = true;
    }
    std::this_thread::sleep_for(poll_interval);
  }
  ProcessResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  result.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  const std::optional<double> busy_after = busy_seconds();
  if (busy_before && busy_after) {
    const double others = *busy_after - *busy_before - result.processor_s;
    const double cores = std::max(1U, std::thread::hardware_concurrency());
    // The kernel counts in hundredths of a second per core: short runs may come out below 0.
    result.others_share = std::clamp(others / (result.wall_s * cores), 0.0, 1.0);
  }
  return result;
}

std::string last_line(const std::filesystem::path& log) {
  std::ifstream in(log);
  std::string line, last = "no message";
  while (std::getline(in, line)) {
    if (!line.empty()) last = line;
  }
  return last;
}

}  // namespace dkp_slam

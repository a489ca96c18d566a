#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dkp_slam {

/// What a child process was like.
struct ProcessResult {
  int exit_code = 0;         ///< 128 + signal where one ended it
  double wall_s = 0.0;       ///< from start to end
  double processor_s = 0.0;  ///< of all its threads
  double others_share =
      0.0;  ///< processor time of all other programs meanwhile, of all cores' time
};

/// Runs a program and waits for its end. Standard output and error go into the file `log`, standard
/// input is empty. Once `stop` says so the child gets one SIGINT, to save what it has; the wait
/// goes on. It runs in a process group of its own, so Ctrl-C on the terminal does not reach it
/// twice. Throws `Error` when the program cannot be started.
ProcessResult run_process(
    const std::vector<std::string>& command, const std::filesystem::path& log,
    const std::function<bool()>& stop = [] { return false; });

/// The last line of a child's log that says something.
std::string last_line(const std::filesystem::path& log);

}  // namespace dkp_slam

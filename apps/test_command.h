#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/test_program.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam::testing {

/// A test that starts the program as a user does, in a folder of its own.
class CommandTest : public FolderTest {
 protected:
  /// The folder is its HOME: no weights of the user's, as what runs must not depend on them.
  Program start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> environment{"HOME=" + folder_.string()};
    environment.insert(environment.end(), environment_.begin(), environment_.end());
    return {folder_, arguments, environment};
  }
  /// Runs it to the end, and keeps what it says; exit code, as Program::wait.
  int call(const std::vector<std::string>& arguments) {
    const Program program = start(arguments);
    const int code = program.wait();
    stdout_ = program.out();
    stderr_ = program.err();
    return code;
  }
  /// The same, with `more` after `arguments`.
  int call(std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return call(arguments);
  }

  /// Exit code of a command line of bash in the folder, where $P is the program.
  int bash(const std::string& line) const {
    const std::filesystem::path script = folder_ / "line.sh";
    std::ofstream(script) << fmt::format(
        "set -o pipefail\nexec >/dev/null\ncd '{}'\nexport HOME='{}' P='{}'\n{}\n",
        folder_.string(), folder_.string(), DKP_SLAM_PROGRAM, line);
    const int status = std::system(fmt::format("bash '{}'", script.string()).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  /// What such a line has sent to the file err there.
  std::string err() const { return content(folder_ / "err"); }

  /// NAME=VALUE, besides HOME.
  std::vector<std::string> environment_;
  std::string stdout_, stderr_;
};

}  // namespace dkp_slam::testing

// Renders a recording for the tests, or finds that it is there:
//
//   dkp_slam_recording FOLDER SCENARIO LENGTH FIRST_FRAME DIVISOR
//
// prints the file that holds at least so many frames. Files are named by a hash of this program and
// of the libraries that it runs with: whatever may change a pixel changes the name, and files of
// other names go. Of several that ask at once one renders, and the others wait.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/file.h>
#include <unistd.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"
#include "tests/support/recording.h"

namespace dkp_slam::testing {
namespace {

namespace fs = std::filesystem;

int add_library(dl_phdr_info* info, std::size_t, void* text) {
  const fs::path file = info->dlpi_name;
  if (file.empty() || !fs::exists(file)) return 0;  // this program, and what the kernel maps
  *static_cast<std::string*>(text) +=
      fmt::format("{} {} {}\n", file.string(), fs::file_size(file),
                  fs::last_write_time(file).time_since_epoch().count());
  return 0;
}

std::string name_of_this_build() {
  std::string all = fingerprint("/proc/self/exe");
  dl_iterate_phdr(add_library, &all);
  return text_fingerprint(all);
}

/// Held by one process at a time, until it ends.
void wait_for_lock(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX) != 0) {
    throw Error(file.string() + ": cannot be locked; are you allowed to write there?");
  }
}

void remove_all_but(const fs::path& folder, const std::string& build) {
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.path().filename().string().starts_with(build)) old.push_back(entry.path());
  }
  std::error_code others_may_be_faster;
  for (const fs::path& file : old) fs::remove(file, others_may_be_faster);
}

fs::path provide(const std::vector<std::string>& arguments) {
  if (arguments.size() != 5) throw Error("FOLDER SCENARIO LENGTH FIRST_FRAME DIVISOR");
  const fs::path folder = arguments[0];
  const std::string& scenario = arguments[1];
  const std::size_t length = std::stoul(arguments[2]), first = std::stoul(arguments[3]);
  const int divisor = std::stoi(arguments[4]);
  fs::create_directories(folder);
  const std::string build = name_of_this_build();
  const fs::path file = folder / fmt::format("{}-{}-{}-{}", build, scenario, first, divisor);
  wait_for_lock(file.string() + ".lock");
  if (Recording::length_of(file) < length) {
    remove_all_but(folder, build);
    Recording(scenario, smaller(SyntheticOptions::default_camera(), divisor), length, first)
        .save(file);
  }
  return file;
}

}  // namespace
}  // namespace dkp_slam::testing

int main(int argc, char** argv) {
  try {
    std::puts(dkp_slam::testing::provide({argv + 1, argv + argc}).c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

// A process for map_kill_test to kill: grows a map and keeps its file up to date.
//   map_kill_child FILE LOG STEPS [BYTES]
// Goes on where FILE ended, and lets go of it every so many STEPS, to take hold of it again. A line
// in LOG after each step: nanoseconds of the steady clock, steps. BYTES: as if the disk were full
// when a file reaches this size; the process ends with the error.

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <sys/resource.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_writer.h"

namespace {

using dkp_slam::testing::GrowingMap;
using Clock = std::chrono::steady_clock;

void run_session(const std::filesystem::path& file, int steps, GrowingMap& grown, std::FILE* log) {
  std::unique_ptr<dkp_slam::MapWriter> writer;
  if (std::filesystem::exists(file)) {
    dkp_slam::StoredMap stored = dkp_slam::read_map(file);
    grown.grow_to(GrowingMap::steps_of(stored.map));
    writer = std::make_unique<dkp_slam::MapWriter>(file, std::move(stored.state));
  } else {
    writer = std::make_unique<dkp_slam::MapWriter>(file, grown.map);
  }
  for (int i = 0; i < steps; ++i) {
    grown.step();
    const auto now = Clock::now().time_since_epoch();
    std::fprintf(
        log, "%lld %d\n",
        static_cast<long long>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()),
        grown.steps());
    std::fflush(log);
    if (i % 20 == 0) writer->update(grown.map);  // twice a second, as a run does
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  writer->update(grown.map);
  writer->finish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  if (argc > 4) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlim_t bytes = std::strtoul(argv[4], nullptr, 10);
    const rlimit limit{bytes, bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 3;
  }
  std::FILE* log = std::fopen(argv[2], "a");
  if (!log) return 3;
  try {
    GrowingMap grown;
    while (true) run_session(argv[1], std::atoi(argv[3]), grown, log);
  } catch (const dkp_slam::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

// Measures what it costs to keep a map file up to date, and to read it: a generated map grows, and
// every update has two keyframes more to write.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "bench/benches.h"
#include "bench/thread_time.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_writer.h"

namespace dkp_slam::bench {
namespace map {
namespace {

struct BenchOptions {
  std::filesystem::path file;
  int keyframes = 2000;
  int features = 300;
  int updates = 10;
};

void measure(const BenchOptions& options) {
  testing::GrowingMap grown(options.features);
  while (grown.map.live_keyframes() < options.keyframes) grown.step();
  MapWriter writer(options.file, grown.map);
  ChangeFinder finder;
  // What the tracking thread does; writing is another one's.
  const auto update_ms = [&] {
    const ThreadTime time;
    const MapChange change = finder.find(grown.map);
    const double found = time.ms();
    writer.write(change);
    return found;
  };
  const double first = update_ms();
  std::vector<double> later;
  for (int i = 0; i < options.updates; ++i) {
    grown.grow_to(grown.steps() + 2);
    later.push_back(update_ms());
  }
  std::sort(later.begin(), later.end());
  writer.finish();
  const auto bytes = static_cast<double>(std::filesystem::file_size(options.file));
  const ThreadTime time;
  const StoredMap stored = read_map(options.file);
  fmt::print(
      "{} keyframes with {} features, {} landmarks: update of all {:.1f} ms, of two keyframes "
      "median {:.2f} ms (most {:.2f}); file {:.1f} MB, {:.1f} kB a keyframe; read in {:.0f} ms\n",
      stored.map.live_keyframes(), options.features, stored.map.live_landmarks(), first,
      later[later.size() / 2], later.back(), bytes / 1e6, bytes / 1e3 / stored.map.live_keyframes(),
      time.ms());
}

}  // namespace
}  // namespace map

void add_map(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("map", "Cost of a map file, milliseconds of processor time");
  const auto options = std::make_shared<map::BenchOptions>();
  command->add_option("FILE", options->file, "To be made")->required();
  command->add_option("--keyframes", options->keyframes)->capture_default_str();
  command->add_option("--features", options->features)->capture_default_str();
  command->add_option("--updates", options->updates)->capture_default_str();
  command->callback([options] { map::measure(*options); });
}

}  // namespace dkp_slam::bench

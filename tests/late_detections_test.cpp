#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/late_detections.h"

namespace dkp_slam {
namespace {
using namespace testing;
TEST(Explore, Delays) {
  const char* name = std::getenv("SCENE");
  const int first = std::atoi(std::getenv("FIRST")), count = std::atoi(std::getenv("COUNT")), div = std::atoi(std::getenv("DIV"));
  const PreparedRecording world(name, count, first, div);
  std::vector<double> delays{0.0, 0.05, 0.1, 0.2, 0.4};
  if (std::getenv("DELAYS")) { delays.clear(); std::stringstream in(std::getenv("DELAYS")); double d; while (in >> d) delays.push_back(d); }
  std::vector<int> seeds{1};
  if (std::getenv("SEEDS")) seeds = {1, 2, 3};
  for (double delay : delays) for (int seed : seeds) {
    SlamConfig config; config.seed = seed;
    const LateOutcome o = play_late(world, config, DelayedDetections(world.answers, delay));
    std::printf("%s delay %.2f seed %d removed %.4f kept %.4f ate %.5f lost %d\n", name, delay, seed, o.dynamic_removed, o.static_kept, o.error, o.lost);
    std::fflush(stdout);
  }
}
}
}

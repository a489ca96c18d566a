// What a run's summary.json says to those who go on from its folder: bench, demo, export.
#include <cmath>

#include "apps/run_summary.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  const std::string text = text_of(bytes);
  const apps::RunInput input = apps::parse_run_input(text);
  require(!input.frame_rate || std::isfinite(*input.frame_rate), "a rate that is none");
  takes([&] {
    const apps::RunSummary summary = apps::parse_run_summary(text);
    require(summary.input.sequence == input.sequence && summary.input.camera == input.camera,
            "the same text says two things");
    constexpr std::size_t most = std::size_t{1} << 53U;
    require(summary.frames <= most && summary.features <= most, "a count that no double counts");
    for (const auto& [stage, ms] : summary.median_ms) {
      require(std::isfinite(ms), "a time that is none");
    }
  });
}

std::vector<std::string> seeds() {
  return {R"({"options": {"sequence": "a", "topics": "/c,/d", "camera": "fr1", "model": "m.onnx",)"
          R"( "frame_rate": 30.0}, "detector": "motion", "frames": 12, "skipped_frames": 0,)"
          R"( "features": 9000, "features_removed": 30, "keyframes": 3, "landmarks": 400,)"
          R"( "loops_closed": 0, "maps": [12], "maps_joined": 0,)"
          R"( "median_ms": {"frame": 12.5, "tracking": 3}, "peak_memory_mb": 160.5})",
          R"({"options": {"sequence": "-", "frame_rate": -0.0}})", "[]"};
}

const Registration registration({"summary", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dkp_slam/system/slam.h"

namespace dkp_slam::apps {

/// What the frames of a run amounted to.
struct RunTotals {
  std::vector<FrameReport> frames;
  std::size_t skipped_frames = 0;  ///< images that could not be read
  int dropped_frames = 0;          ///< too late in real time
  int detector_failures = 0;
  bool interrupted = false;
};

/// One line per frame, a column per stage, milliseconds.
std::string timings_csv(const std::vector<FrameReport>& frames);

/// Counts and medians of a run; `options` is what the user asked for and what was chosen for him.
nlohmann::ordered_json summary_json(const RunTotals& totals, const Map& map,
                                    const nlohmann::ordered_json& options);

/// Megabytes that the process has had in memory at most, as the kernel counts (VmHWM).
double peak_memory_mb();

}  // namespace dkp_slam::apps

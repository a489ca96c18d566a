#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace dkp_slam::apps {

/// What a run was made of, by its summary.json; empty where that says nothing.
struct RunInput {
  std::string sequence, topics, camera, model;
  std::optional<double> frame_rate;  ///< Hz
};

/// What a run came to, by its summary.json.
struct RunSummary {
  RunInput input;
  std::string detector;
  std::size_t frames = 0, skipped_frames = 0, features = 0, features_removed = 0;
  std::size_t keyframes = 0, landmarks = 0, loops_closed = 0, maps_joined = 0, maps = 0;
  double peak_memory_mb = 0.0;
  std::map<std::string, double> median_ms;  ///< of each stage
};

/// Of a summary.json's text. Throws `Error`, which names the field that is missing or none.
RunSummary parse_run_summary(const std::string& text);
/// The same, but takes what it finds: of a text that is no summary, nothing.
RunInput parse_run_input(const std::string& text);

/// Of the run that left this folder. Throws `Error` with the file's name.
RunSummary read_run_summary(const std::filesystem::path& run);
/// Of the run that left this folder, nothing where it left no summary.
RunInput read_run_input(const std::filesystem::path& run);

}  // namespace dkp_slam::apps

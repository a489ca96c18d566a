#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "bench/results/figures.h"
#include "dkp_slam/evaluation/measure/sequence_name.h"

namespace dkp_slam::bench {

/// What is the same for all runs.
struct MeasureOptions {
  std::filesystem::path data;    ///< holds the sequence folders
  std::filesystem::path config;  ///< holds the camera files
  /// Camera file in `config` of each sequence whose folder neither holds nor tells its camera.
  std::map<std::string, std::string> cameras;
  std::filesystem::path program;  ///< the dkp-slam to measure
  std::filesystem::path model;    ///< YOLOX; empty: the motion detector runs
  std::filesystem::path runs;     ///< a folder per run goes here
};

/// What a file holds. Throws `Error` when it cannot be read.
std::string text_of(const std::filesystem::path& path);

/// Camera file of a sequence: as given, else its folder's camera.yaml, else by its name. Throws
/// `Error` where nothing tells it.
std::filesystem::path camera_of(const MeasureOptions& options, const std::string& sequence);

/// Where a run's output lies.
std::filesystem::path run_folder(const MeasureOptions& options, const RunKey& key);

/// Whether a finished run of this program with these options lies in its folder already.
bool is_finished(const MeasureOptions& options, const RunKey& key);

/// Runs the program on a sequence, offline, then once more on the detections of that run. Where the
/// first seed's run of the sequence and mode is there and good, only the latter, on its detections.
/// False when `stop` ended it early; the folder then does not count as finished. A run that fails
/// counts, with its problem.
bool measure_run(const MeasureOptions& options, const RunKey& key,
                 const std::function<bool()>& stop);

/// The figures of a finished run: its path scored against the sequence's groundtruth.txt.
RunFigures read_run(const MeasureOptions& options, const RunKey& key);

/// Whether the sequence has true masks.
bool has_masks(const MeasureOptions& options, const std::string& sequence);

/// Masks and features of an earlier `measure_masks` by the same program and options.
std::optional<MaskFigures> read_masks(const MeasureOptions& options, const RunKey& key);

/// Runs the system in this process and scores each frame's mask and features against mask/.
/// `progress` is told the number of frames done. Nothing when `stop` ended it early.
std::optional<MaskFigures> measure_masks(const MeasureOptions& options, const RunKey& key,
                                         const std::function<bool()>& stop,
                                         const std::function<void(std::size_t)>& progress);

}  // namespace dkp_slam::bench

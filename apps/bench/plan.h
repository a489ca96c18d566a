#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/config_options.h"

namespace dkp_slam::apps {

/// A sequence to run, with all that its results depend on.
struct BenchSequence {
  std::string name;  ///< its folder's
  std::filesystem::path folder, camera;
  std::string scenario;     ///< what it was generated from; empty for a recording
  std::string fingerprint;  ///< of its lists, its true path and its camera file; not of the images
};

/// What finds objects in a run.
struct BenchDetector {
  std::string name;  ///< yolox, motion, boxes or none
  std::filesystem::path model;
  std::string fingerprint;  ///< of the model; empty without one
};

/// One run to be made.
struct BenchJob {
  BenchSequence sequence;
  std::string mode;
  BenchDetector detector;
  std::uint64_t seed = 1;
  std::vector<std::string> config;  ///< arguments of the run that give its configuration
  std::string config_fingerprint;   ///< of all its options; empty for those built in
};

/// What the user asked for.
struct BenchPlanOptions {
  std::vector<std::string> folders;
  std::vector<std::string> modes{"off", "d", "dk", "dkp", "dkp+"};
  std::vector<std::string> detectors{"auto"};
  std::string camera;  ///< a file or one of `camera_names`; empty: each sequence's own
  std::string model;
  int repeat = 3;  ///< seeds 1, 2, ...
  ConfigOptions config;
};

/// Part `index` (from 1) of `count` equal parts.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// Reads "2/8". Throws `Error` for anything else, and for an index outside 1 to the count.
Shard parse_shard(const std::string& text);

/// Every run that was asked for, seed by seed, so that an interrupted bench has seen all sequences.
/// Modes off and masks, which use no detector, are run once, not once for each. Throws `Error` for
/// a folder without a sequence or true path, two folders of one name, a camera that is not known,
/// and recorded boxes, masks or a model that are missing.
std::vector<BenchJob> plan_jobs(const BenchPlanOptions& options);

/// The runs of one part: every count-th. All parts together are all runs, each once.
std::vector<BenchJob> jobs_of_shard(const std::vector<BenchJob>& jobs, const Shard& shard);

/// All that a run's result depends on but the program: sequence, camera, mode, detector, seed. Of
/// contents, not of where the files lie, so that machines agree on it.
std::string options_fingerprint(const BenchJob& job);

}  // namespace dkp_slam::apps

#include "apps/bench/plan.h"

#include <algorithm>
#include <charconv>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/camera_choice.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

/// "walking_xyz" for a folder that `synth` made; empty for others.
std::string scenario_of(const fs::path& folder) {
  std::ifstream in(folder / "synth.json");
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("scenario") || !json["scenario"].is_string()) return "";
  return json["scenario"];
}

BenchSequence read_sequence(const std::string& text, const std::string& camera) {
  BenchSequence sequence;
  std::error_code error;
  sequence.folder = fs::canonical(text, error);
  if (error || !fs::is_directory(sequence.folder)) {
    throw Error(text + ": no such folder; give folders of sequences in TUM format");
  }
  sequence.name = sequence.folder.filename();
  const bool listed =
      fs::exists(sequence.folder / "associations.txt") || fs::exists(sequence.folder / "rgb.txt");
  if (!listed) {
    throw Error(text +
                ": holds neither rgb.txt nor associations.txt; `dkp-slam record` makes a folder in "
                "TUM format of other layouts");
  }
  if (!fs::exists(sequence.folder / "groundtruth.txt")) {
    throw Error(text +
                ": has no groundtruth.txt, without which there is nothing to compare; leave "
                "it out");
  }
  sequence.camera = fs::absolute(choose_camera(sequence.folder, camera));
  sequence.scenario = scenario_of(sequence.folder);
  std::string prints = fingerprint(sequence.camera);
  for (const char* file :
       {"associations.txt", "rgb.txt", "depth.txt", "groundtruth.txt", "synth.json"}) {
    const fs::path path = sequence.folder / file;
    prints += fmt::format(" {} {}", file, fs::exists(path) ? fingerprint(path) : "none");
  }
  sequence.fingerprint = text_fingerprint(prints);
  return sequence;
}

std::vector<BenchSequence> read_sequences(const BenchPlanOptions& options) {
  std::vector<BenchSequence> sequences;
  for (const std::string& folder : options.folders) {
    sequences.push_back(read_sequence(folder, options.camera));
    for (std::size_t i = 0; i + 1 < sequences.size(); ++i) {
      if (sequences[i].name != sequences.back().name) continue;
      throw Error(fmt::format("{} and {}: two sequences of one name; rename a folder",
                              sequences[i].folder.string(), folder));
    }
  }
  return sequences;
}

BenchDetector choose_detector(const std::string& name, const std::string& model) {
  BenchDetector detector{name, {}, {}};
  if (name == "yolox" || name == "auto") {
    const auto found = find_model(model);
    if (!found && name == "yolox") throw Error("no YOLOX model; " + model_advice());
    detector.name = found ? "yolox" : "motion";
    if (found) {
      detector.model = fs::absolute(*found);
      detector.fingerprint = fingerprint(detector.model);
    }
  }
  return detector;
}

std::vector<BenchDetector> choose_detectors(const BenchPlanOptions& options,
                                            const std::vector<BenchSequence>& sequences) {
  std::vector<BenchDetector> detectors;
  for (const std::string& name : options.detectors) {
    const BenchDetector chosen = choose_detector(name, options.model);
    const bool known = std::any_of(detectors.begin(), detectors.end(),
                                   [&](const auto& d) { return d.name == chosen.name; });
    if (!known) detectors.push_back(chosen);
    if (name != "boxes") continue;
    for (const BenchSequence& sequence : sequences) {
      if (fs::exists(sequence.folder / "detections.txt")) continue;
      throw Error(sequence.folder.string() +
                  ": has no detections.txt; leave boxes out of --detector, or the sequence out");
    }
  }
  return detectors;
}

void check_masks(const BenchSequence& sequence) {
  if (fs::is_directory(sequence.folder / "mask")) return;
  throw Error(sequence.folder.string() +
              ": has no folder mask; leave masks out of --modes, or the sequence out");
}

/// The arguments that give each run the configuration that the user wants.
std::vector<std::string> config_arguments(const ConfigOptions& options) {
  std::vector<std::string> arguments;
  if (!options.file.empty()) arguments = {"--config", fs::absolute(options.file).string()};
  for (const std::string& assignment : options.assignments) {
    arguments.insert(arguments.end(), {"--set", assignment});
  }
  return arguments;
}

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  bool good = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  if (good) {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    good = second.ec == std::errc() && second.ptr == end;
  }
  if (!good || shard.index < 1 || shard.index > shard.count) {
    throw Error(text + ": no part I/N of the runs, such as 1/4 to 4/4");
  }
  return shard;
}

std::vector<BenchJob> plan_jobs(const BenchPlanOptions& options) {
  const std::vector<BenchSequence> sequences = read_sequences(options);
  const std::vector<BenchDetector> detectors = choose_detectors(options, sequences);
  const std::vector<std::string> config = config_arguments(options.config);
  const std::string config_fingerprint =
      config.empty() ? "" : text_fingerprint(config_text(make_config(options.config)));
  std::vector<BenchJob> jobs;
  for (int repetition = 1; repetition <= options.repeat; ++repetition) {
    const auto seed = static_cast<std::uint64_t>(repetition);
    for (const BenchSequence& sequence : sequences) {
      std::vector<std::string> done;
      for (const std::string& mode : options.modes) {
        if (std::find(done.begin(), done.end(), mode) != done.end()) continue;
        done.push_back(mode);
        if (mode == mode_info(DynamicsMode::masks).name) check_masks(sequence);
        if (!mode_info(mode_named(mode)).detector) {
          jobs.push_back({sequence, mode, {"none", {}, {}}, seed, config, config_fingerprint});
          continue;
        }
        for (const BenchDetector& detector : detectors) {
          jobs.push_back({sequence, mode, detector, seed, config, config_fingerprint});
        }
      }
    }
  }
  return jobs;
}

std::vector<BenchJob> jobs_of_shard(const std::vector<BenchJob>& jobs, const Shard& shard) {
  std::vector<BenchJob> part;
  for (std::size_t i = shard.index - 1; i < jobs.size(); i += shard.count) part.push_back(jobs[i]);
  return part;
}

std::string options_fingerprint(const BenchJob& job) {
  std::string boxes;
  if (job.detector.name == "boxes") {
    boxes = fingerprint(job.sequence.folder / "detections.txt");
  }
  const std::string config = job.config_fingerprint.empty() ? "" : " " + job.config_fingerprint;
  return text_fingerprint(fmt::format("{} {} {} {} {} {} {}{}", job.sequence.name,
                                      job.sequence.fingerprint, job.mode, job.detector.name,
                                      job.detector.fingerprint, boxes, job.seed, config));
}

}  // namespace dkp_slam::apps

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dkp_slam {

/// One run of `dkp-slam bench` and what came of it: a line of results.jsonl.
struct RunRecord {
  std::string sequence;  ///< its folder's name
  std::string scenario;  ///< what it was generated from; empty for a recording
  std::string mode;      ///< off, d, dk, dkp, dkp+
  std::string detector;  ///< yolox, motion, boxes (recorded with the sequence) or none
  std::string model;     ///< file name of the detector's weights, or empty
  std::uint64_t seed = 1;

  int exit_code = 0;    ///< of the process, 128 + signal where one ended it
  std::string problem;  ///< why there are no figures; empty after a good run
  std::size_t frames = 0;
  std::size_t lost = 0;                              ///< frames without a pose in the trajectory
  double ate_m = 0.0, ate_deviation_m = 0.0;         ///< RMSE and standard deviation
  std::optional<double> rpe_s_m, rpe_s_deg;          ///< RMSE over one second
  std::optional<double> rpe_frame_m, rpe_frame_deg;  ///< RMSE from frame to frame
  std::size_t features = 0, removed = 0;             ///< over all frames
  std::size_t keyframes = 0, landmarks = 0;          ///< of the map at the end
  std::size_t loops_closed = 0, maps_joined = 0;
  std::size_t maps = 0;  ///< that frames were localised in and that never met; 1 as a rule
  std::map<std::string, double> stage_ms;  ///< medians over frames, by stage
  double total_s = 0.0;                    ///< the process from start to end
  double processor_s = 0.0;                ///< of all its threads
  double others_share = 0.0;  ///< of the machine's processor time that other processes took
  double peak_memory_mb = 0.0;
  int jobs = 1;  ///< runs at the same time

  std::string version;  ///< of the program, in words
  std::string program;  ///< fingerprint of the program's file
  std::string options;  ///< fingerprint of everything else that the result depends on
  std::string machine;
  std::string date;  ///< UTC, ISO 8601
};

/// Sequence, mode, detector with its model, and seed, which tell a record from all others of a
/// bench. Good as a relative path, too: "walking_xyz/dkp+-motion/seed1".
std::string run_name(const RunRecord& record);

/// One line of JSON without the line break.
std::string to_json_line(const RunRecord& record);

/// The reverse. Throws `Error` for anything but an object with the fields of a record of the right
/// kinds, and for names that could lead out of a folder.
RunRecord parse_json_line(const std::string& line);

/// The records of a file in their order; none when there is no such file. What is no record, the
/// rest of a write that was cut off for instance, is left out with a warning.
std::vector<RunRecord> read_records(const std::filesystem::path& path);

/// Adds a line to the file, whole, also when other processes do the same. Throws `Error` when it
/// cannot be written.
void append_record(const std::filesystem::path& path, const RunRecord& record);

/// Of several records of the same name the one made last. In the order of the report: sequences
/// (the paper's first, in its order), modes, detectors, seeds.
std::vector<RunRecord> latest_records(const std::vector<RunRecord>& records);

/// "off", "d", "dk", "dkp", "dkp+".
const std::vector<std::string>& bench_modes();
/// "none", "motion", "boxes", "yolox".
const std::vector<std::string>& bench_detectors();

}  // namespace dkp_slam

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/report/run_record.h"

namespace dkp_slam {

/// What a report says beside the records.
struct BenchReportOptions {
  /// Holds a folder by `run_name` for each record with trajectory.txt and timings.csv, and a folder
  /// by sequence with groundtruth.txt. What is missing is not drawn.
  std::filesystem::path runs;
  std::string date;
  std::vector<std::string> warnings;  ///< of whoever made the records: interrupted, incomplete
};

/// The page of a bench: tables as the paper's beside its published figures, paths, errors over
/// time, times, every run. Of several records of one name the latest counts.
std::string bench_report(const std::vector<RunRecord>& records, const BenchReportOptions& options);

}  // namespace dkp_slam

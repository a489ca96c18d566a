#pragma once

#include <string>
#include <vector>

#include "bench/results/figures.h"
#include "dkp_slam/evaluation/measure/machine.h"

namespace dkp_slam::bench {

/// What was asked for and where it ran.
struct ReportHeader {
  std::string date;
  Machine machine;
  std::string command;
  std::string detector;  ///< in words
  std::vector<std::string> sequences, modes;
  std::vector<std::uint64_t> seeds;
  bool complete = true;  ///< false when it was interrupted
};

/// The whole page in Markdown: goals, ablation, drift, times, other systems, every run.
std::string report(const ReportHeader& header, const Results& results);

/// The lines of the goals alone.
std::string targets_table(const Results& results);

/// ATE RMSE and S.D. and lost frames of all sequences, a row per mode, medians over the runs.
std::string ablation_table(const std::vector<std::string>& sequences,
                           const std::vector<std::string>& modes, const Results& results);

}  // namespace dkp_slam::bench

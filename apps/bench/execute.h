#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/plan.h"
#include "dkp_slam/evaluation/report/run_record.h"

namespace dkp_slam::apps {

/// What is the same for all runs of a bench.
struct BenchSetup {
  std::filesystem::path program;  ///< the dkp-slam to run
  std::string program_fingerprint, version, machine;
  std::filesystem::path out;  ///< results.jsonl and runs/
  int jobs = 1;               ///< runs at the same time
};

/// The fields of a record that say what was run; no figures.
RunRecord record_of(const BenchSetup& setup, const BenchJob& job);

/// Whether one of the records is of this very run: the same program, options and inputs. Runs that
/// a signal ended are no result.
bool is_done(const std::vector<RunRecord>& records, const RunRecord& wanted);

/// Runs the program on one job as a process of its own and scores the path against the sequence's
/// groundtruth.txt. A run that fails gives a record with a problem. Nothing when `stop` ended it.
std::optional<RunRecord> execute(const BenchSetup& setup, const BenchJob& job,
                                 const std::function<bool()>& stop);

/// Runs all jobs, `setup.jobs` at the same time, and adds each record to the results as soon as it
/// is there; then `finished` is told, one record at a time. Ends early when `stop` says so; the
/// processes are told to end, and waited for. Throws what `execute` throws, after the other runs
/// have ended.
void execute_all(const BenchSetup& setup, const std::vector<BenchJob>& jobs,
                 const std::function<bool()>& stop,
                 const std::function<void(const RunRecord&)>& finished);

}  // namespace dkp_slam::apps

#include "apps/bench/merge.h"

#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/output.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

/// Records and, by their line, the output folder they are from.
struct Gathered {
  std::vector<RunRecord> records;
  std::map<std::string, fs::path> origins;

  void add(const fs::path& folder) {
    for (const RunRecord& record : read_records(results_file(folder))) {
      records.push_back(record);
      origins.emplace(to_json_line(record), folder);
    }
  }
};

void take_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::exists(from) || fs::equivalent(from, to, error)) return;
  fs::create_directories(to.parent_path());
  fs::copy_file(from, to, fs::copy_options::overwrite_existing);
}

void copy_run(const RunRecord& record, const fs::path& from, const fs::path& to) {
  try {
    const fs::path name = run_name(record);
    for (const char* file : {"trajectory.txt", "timings.csv", "summary.json"}) {
      take_file(runs_folder(from) / name / file, runs_folder(to) / name / file);
    }
    const fs::path truth = fs::path(record.sequence) / "groundtruth.txt";
    take_file(runs_folder(from) / truth, runs_folder(to) / truth);
  } catch (const fs::filesystem_error& error) {
    throw Error(fmt::format("cannot copy the files of {}: {}", run_name(record), error.what()));
  }
}

}  // namespace

std::size_t merge_benches(const BenchMergeOptions& options) {
  Gathered gathered;
  gathered.add(options.out);
  for (const std::string& folder : options.folders) {
    if (!fs::exists(results_file(folder))) {
      throw Error(folder + ": holds no results.jsonl; give output folders of dkp-slam bench");
    }
    gathered.add(folder);
  }
  const std::vector<std::string> programs = programs_of(gathered.records);
  if (programs.size() > 1 && !options.mixed) {
    throw Error(
        fmt::format("these are results of {} different programs ({}), which do not compare; merge "
                    "those of one, or say --mixed",
                    programs.size(), fmt::join(programs, ", ")));
  }
  const std::vector<RunRecord> records = latest_records(gathered.records);
  prepare_output(options.out);
  std::string lines;
  for (const RunRecord& record : records) {
    const std::string line = to_json_line(record);
    copy_run(record, gathered.origins.at(line), options.out);
    lines += line + "\n";
  }
  write_file_atomically(results_file(options.out), lines);
  std::vector<std::string> warnings;
  if (programs.size() > 1) {
    warnings.push_back(fmt::format("Results of {} different programs.", programs.size()));
  }
  write_bench_report(options.out, records, warnings);
  return records.size();
}

}  // namespace dkp_slam::apps

#include "apps/bench/output.h"

#include <set>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/machine.h"
#include "dkp_slam/evaluation/report/bench_report.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;

fs::path results_file(const fs::path& out) { return out / "results.jsonl"; }
fs::path runs_folder(const fs::path& out) { return out / "runs"; }
fs::path report_file(const fs::path& out) { return out / "report.html"; }

void prepare_output(const fs::path& out) {
  std::error_code error;
  fs::create_directories(runs_folder(out), error);
  if (error) {
    throw Error(fmt::format("cannot make the output folder {}: {}; choose another --out",
                            out.string(), error.message()));
  }
  check_writable(results_file(out));
  check_writable(report_file(out));
  check_writable(runs_folder(out) / "probe");
}

void write_bench_report(const fs::path& out, const std::vector<RunRecord>& records,
                        const std::vector<std::string>& warnings) {
  write_file_atomically(report_file(out),
                        bench_report(records, {runs_folder(out), today(), warnings}));
}

std::vector<std::string> programs_of(const std::vector<RunRecord>& records) {
  std::set<std::string> programs;
  for (const RunRecord& record : records) programs.insert(record.program);
  return {programs.begin(), programs.end()};
}

std::string count_of(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace dkp_slam::apps

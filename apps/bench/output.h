#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/report/run_record.h"

namespace dkp_slam::apps {

/// Where results, the files of the runs and the report lie within an output folder.
std::filesystem::path results_file(const std::filesystem::path& out);
std::filesystem::path runs_folder(const std::filesystem::path& out);
std::filesystem::path report_file(const std::filesystem::path& out);

/// Makes the folder and throws `Error` where results could not be written into it now.
void prepare_output(const std::filesystem::path& out);

/// Writes report.html about these records.
void write_bench_report(const std::filesystem::path& out, const std::vector<RunRecord>& records,
                        const std::vector<std::string>& warnings);

/// The fingerprints of the programs that made the records, each once.
std::vector<std::string> programs_of(const std::vector<RunRecord>& records);

/// "1 run", "3 runs".
std::string count_of(std::size_t count, const std::string& what);

}  // namespace dkp_slam::apps

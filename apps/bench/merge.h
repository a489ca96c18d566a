#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace dkp_slam::apps {

struct BenchMergeOptions {
  std::vector<std::string> folders;  ///< outputs of bench
  std::filesystem::path out;         ///< results already there are kept
  bool mixed = false;                ///< take results of different programs together
};

/// Brings the results of several benches together, of one run the latest, with the files that the
/// report draws from, and writes the report. Returns the number of results. Throws `Error` for a
/// folder without results, and for results of different programs unless `mixed`.
std::size_t merge_benches(const BenchMergeOptions& options);

}  // namespace dkp_slam::apps

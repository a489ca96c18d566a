#pragma once

#include <string>
#include <vector>

namespace dkp_slam::bench {

/// Figures of other systems as they were published or measured, in the words of their source.
struct PublishedTable {
  std::string title;
  std::string source;  ///< where the figures are from, and how far they can be compared
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Other systems on the very sequences measured here, as rows below our own; columns: system, ATE
/// of the four sequences, tracking time per frame.
const PublishedTable& published_on_same_data();

/// Figures of the paper and of other papers on whole fr3 sequences.
const std::vector<PublishedTable>& published_elsewhere();

/// The paper's Table 7 in the columns: what, A, B, C, tracking; milliseconds, averages.
const PublishedTable& published_times();

}  // namespace dkp_slam::bench

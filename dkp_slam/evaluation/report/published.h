#pragma once

#include <string>
#include <vector>

namespace dkp_slam {

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

/// The paper's Tables 2 to 5 in the columns: system, then the sequences of `paper_sequences`;
/// metres, RMSE. Of its Table 4 the figures are not at hand: there stand those of other papers on
/// the same sequences.
const PublishedTable& published_ate_by_base();
const PublishedTable& published_rpe_by_base();
const PublishedTable& published_ate_of_others();
const PublishedTable& published_rpe_of_others();

/// The paper's Table 6: mode as on our command line, then RMSE and S.D. of ATE in turn for each of
/// `paper_sequences`.
const PublishedTable& published_ablation();

/// The paper's Table 8: system, milliseconds per frame, machine.
const PublishedTable& published_system_times();

/// "W/half", "W/rpy", "W/static", "W/xyz", "S/static", "S/xyz": the order of the tables' columns.
const std::vector<std::string>& paper_sequences();

}  // namespace dkp_slam

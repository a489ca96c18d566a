#pragma once

#include <string>

#include "dkp_slam/evaluation/report/record_set.h"

namespace dkp_slam {

/// Every sequence with every configuration: medians over the seeds of all there is to say.
std::string overview_table(const RecordSet& set);

/// The paper's Tables 2 to 5: published figures, then ours, in columns of the paper's six
/// sequences. Which of our rows are of generated twins is said in the row. Empty when no sequence
/// is one of the six.
std::string paper_tables(const RecordSet& set);

/// The paper's Table 6: modes as rows, ATE and its standard deviation.
std::string ablation_section(const RecordSet& set);

/// The paper's Tables 7 and 8.
std::string times_section(const RecordSet& set);

/// A row for every run, failed ones with their reason.
std::string every_run_table(const RecordSet& set);

}  // namespace dkp_slam

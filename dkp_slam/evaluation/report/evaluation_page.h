#pragma once

#include <span>
#include <string>

#include "dkp_slam/evaluation/report.h"

namespace dkp_slam {

/// The page of one trajectory beside the truth: figures, paths, distance and drift over time.
/// `report` is of these two.
std::string evaluation_page(std::span<const StampedPose> truth,
                            std::span<const StampedPose> estimate, const EvaluationReport& report,
                            const std::string& truth_name, const std::string& estimate_name);

}  // namespace dkp_slam

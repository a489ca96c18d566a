#pragma once

#include <span>

#include "dkp_slam/evaluation/axes.h"
#include "dkp_slam/evaluation/canvas.h"
#include "dkp_slam/evaluation/report/scored_path.h"

namespace dkp_slam {

/// Part of a page for a chart with all that belongs to it, points.
struct ChartBox {
  Eigen::Vector2d top_left;
  Eigen::Vector2d size;
};

/// The true path and estimated ones, aligned to it, seen along the truth's z axis: from above where
/// that points up, as in the TUM benchmark. One scale for both axes. An estimate that strays far
/// off is cut at the frame. The truth is drawn where there is an estimate to compare.
void draw_paths_from_above(Canvas& canvas, const ChartBox& box, std::span<const StampedPose> truth,
                           std::span<const ScoredPath> paths);

/// Distance from the truth over time of several runs of one sequence. Where one is several times as
/// large as another the axis is logarithmic.
void draw_errors_over_time(Canvas& canvas, const ChartBox& box, std::span<const ScoredPath> paths);

}  // namespace dkp_slam

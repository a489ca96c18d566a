#pragma once

#include <span>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/axes.h"
#include "dkp_slam/evaluation/canvas.h"

namespace dkp_slam {

/// Size of the figure, points.
constexpr int plot_width = 800;
constexpr int plot_height = 860;

/// Draws the true path and the aligned estimate from the side that shows most of them (the two axes
/// of the truth's world frame along which the path is widest), the differences in red as in the
/// benchmark's own plot, and below it the error over time. `error` is the absolute error of these
/// two trajectories; of the truth only what lies within the estimate's time is drawn.
void draw_trajectories(Canvas& canvas, std::span<const StampedPose> truth,
                       std::span<const StampedPose> estimate, const AbsoluteError& error,
                       const AssociationOptions& association, const std::string& title);

}  // namespace dkp_slam

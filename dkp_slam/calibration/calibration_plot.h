#pragma once

#include <string>

#include "dkp_slam/calibration/calibrate.h"
#include "dkp_slam/evaluation/canvas.h"

namespace dkp_slam {

/// Size of the figure, points.
constexpr int calibration_plot_width = 800;
constexpr int calibration_plot_height = 620;

/// Draws what shows the readout (when each row saw what it saw) and the delay of depth (how far off
/// depth is, the faster it changes), with lines for what was found, its standard deviation, and
/// what the camera file said.
void draw_calibration(Canvas& canvas, const Calibration& calibration, const std::string& title);

}  // namespace dkp_slam

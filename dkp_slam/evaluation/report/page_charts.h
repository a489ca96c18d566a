#pragma once

#include <span>
#include <string>
#include <vector>

#include "dkp_slam/evaluation/canvas.h"
#include "dkp_slam/evaluation/report/scored_path.h"

namespace dkp_slam {

// Charts for `html_page`, whose script (viewer/page/report) draws them: zoom, values where the
// cursor is, series shown and hidden. Each function gives the HTML of one, which holds its data as
// JSON in which nothing can end the element.

/// The true path and estimated ones, aligned to it, from the side that shows most of the truth; the
/// reader may choose another.
std::string path_chart(std::span<const StampedPose> truth, std::span<const ScoredPath> paths,
                       const AssociationOptions& association = {});

/// Errors of a run, in the order of time.
struct ErrorSeries {
  std::string name;
  Colour colour;
  std::vector<double> times;   ///< seconds since the start
  std::vector<double> errors;  ///< metres, one per time
};

/// Errors over time, millimetres, logarithmic where one is several times as large as another.
std::string error_chart(const std::string& title, std::span<const ErrorSeries> series);
/// The same of the distance from the truth.
std::string error_chart(std::span<const ScoredPath> paths);

/// A value of every frame.
struct FrameValues {
  std::string name;
  Colour colour;
  std::vector<double> values;  ///< not negative
};

/// How often each value occurs, percent of the frames.
std::string histogram_chart(const std::string& title, std::span<const FrameValues> series,
                            const std::string& quantity, const std::string& unit);

/// How the charts of a page are used, in a sentence or two.
std::string chart_help();

}  // namespace dkp_slam

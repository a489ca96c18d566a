#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/evaluation/canvas.h"

namespace dkp_slam {

/// What all figures are drawn with.
namespace chart {
constexpr Colour ink{60, 60, 60};
constexpr Colour faint{226, 226, 226};
constexpr Colour truth_colour{40, 40, 40};
constexpr Colour estimate_colour{31, 110, 190};
constexpr Colour error_colour{214, 70, 60};
constexpr double text_size = 13.0;
}  // namespace chart

/// A rectangle of the page with data coordinates, y up.
struct Panel {
  Eigen::Vector2d top_left;  ///< points
  Eigen::Vector2d size;
  Eigen::Vector2d low;  ///< data
  Eigen::Vector2d high;

  Eigen::Vector2d page(const Eigen::Vector2d& data) const;
  Canvas::Line page(const Canvas::Line& data) const;
};

/// A value on an axis that gets a line across the panel and its text.
struct Tick {
  double at = 0.0;  ///< data
  std::string text;
};

/// Ticks at round values, about `wanted` of them, with the digits that tell them apart.
std::vector<Tick> round_ticks(double low, double high, int wanted);

/// Values for the ticks of an axis: multiples of 1, 2 or 5 times a power of ten within [low, high],
/// about `wanted` of them.
std::vector<double> ticks(double low, double high, int wanted);

/// Grid, frame, ticks and names of both axes. They take about 60 points to the left of the panel,
/// 45 below and 25 above it.
void draw_axes(Canvas& canvas, const Panel& panel, const std::vector<Tick>& x_ticks,
               const std::vector<Tick>& y_ticks, const std::string& x_name,
               const std::string& y_name);

struct LegendEntry {
  std::string name;
  Colour colour;
  double width;
};

/// One row whose end is at about `right`, its texts' baseline at the height of it.
void draw_legend(Canvas& canvas, const Eigen::Vector2d& right,
                 const std::vector<LegendEntry>& entries);

/// Points with their times, broken into lines where poses are missing: where they lie several usual
/// intervals apart frames were lost.
std::vector<Canvas::Line> broken_at_gaps(const std::vector<double>& times,
                                         const std::vector<Eigen::Vector2d>& points);

/// Two of the three axes of a frame.
struct View {
  int across = 0, up = 1;

  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return {p[across], p[up]}; }
  std::vector<Eigen::Vector2d> operator()(const std::vector<Eigen::Vector3d>& points) const;
  /// "x [m]" and so on.
  std::string across_name() const;
  std::string up_name() const;
};

/// A panel that shows everything from `low` to `high` (metres, at least a millimetre) with one
/// scale for both axes and a margin, in the middle of a rectangle of the page.
Panel equal_panel(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                  const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace dkp_slam

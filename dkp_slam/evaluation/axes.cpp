#include "dkp_slam/evaluation/axes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "dkp_slam/evaluation/statistics.h"

namespace dkp_slam {

using namespace chart;

namespace {

// A path is broken where its poses lie this many usual intervals apart: frames were lost there.
constexpr double gap_intervals = 4.0;
// What is shown is this much larger than what is drawn.
constexpr double margin = 1.1;
// A camera at rest still gets a view, metres.
constexpr double smallest_extent = 1e-3;

std::string axis_name(int axis) {
  constexpr std::array<const char*, 3> names = {"x [m]", "y [m]", "z [m]"};
  return names[static_cast<std::size_t>(axis)];
}

/// Digits after the point that tell these ticks apart.
int digits_for(const std::vector<double>& values) {
  if (values.size() < 2) return 2;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(values[1] - values[0]) - 1e-9)), 0, 9);
}

constexpr double legend_sample = 24.0;
constexpr double legend_gap = 8.0;

double legend_entry_width(const LegendEntry& entry) {
  // The canvas does not measure text; this is wide enough for both of its fonts.
  return 7.6 * static_cast<double>(entry.name.size()) + legend_sample + legend_gap;
}

}  // namespace

Eigen::Vector2d Panel::page(const Eigen::Vector2d& data) const {
  const Eigen::Vector2d share = (data - low).cwiseQuotient(high - low);
  return top_left + Eigen::Vector2d(share.x() * size.x(), (1.0 - share.y()) * size.y());
}

Canvas::Line Panel::page(const Canvas::Line& data) const {
  Canvas::Line line;
  line.reserve(data.size());
  for (const Eigen::Vector2d& point : data) line.push_back(page(point));
  return line;
}

std::vector<Eigen::Vector2d> View::operator()(const std::vector<Eigen::Vector3d>& points) const {
  std::vector<Eigen::Vector2d> seen;
  for (const Eigen::Vector3d& point : points) seen.push_back((*this)(point));
  return seen;
}

std::string View::across_name() const { return axis_name(across); }
std::string View::up_name() const { return axis_name(up); }

Panel equal_panel(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                  const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d extent = (high - low).cwiseMax(smallest_extent) * margin;
  const Eigen::Vector2d half = 0.5 * extent.cwiseQuotient(size).maxCoeff() * size;
  const Eigen::Vector2d middle = 0.5 * (low + high);
  return {top_left, size, middle - half, middle + half};
}

std::vector<double> ticks(double low, double high, int wanted) {
  const double rough = (high - low) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) step = factor * power;
  }
  std::vector<double> values;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    values.push_back(k == 0.0 ? 0.0 : k * step);  // never "-0"
  }
  return values;
}

std::vector<Tick> round_ticks(double low, double high, int wanted) {
  const std::vector<double> values = ticks(low, high, wanted);
  std::vector<Tick> result;
  for (const double value : values) {
    result.push_back({value, fmt::format("{:.{}f}", value, digits_for(values))});
  }
  return result;
}

void draw_axes(Canvas& canvas, const Panel& panel, const std::vector<Tick>& x_ticks,
               const std::vector<Tick>& y_ticks, const std::string& x_name,
               const std::string& y_name) {
  std::vector<Canvas::Line> grid;
  for (const Tick& x : x_ticks) {
    grid.push_back(panel.page(Canvas::Line{{x.at, panel.low.y()}, {x.at, panel.high.y()}}));
  }
  for (const Tick& y : y_ticks) {
    grid.push_back(panel.page(Canvas::Line{{panel.low.x(), y.at}, {panel.high.x(), y.at}}));
  }
  canvas.lines(grid, faint, 0.8);
  for (const Tick& x : x_ticks) {
    const Eigen::Vector2d at = panel.page(Eigen::Vector2d(x.at, panel.low.y()));
    canvas.text(at + Eigen::Vector2d(0.0, 19.0), x.text, text_size, TextAnchor::middle, ink);
  }
  for (const Tick& y : y_ticks) {
    const Eigen::Vector2d at = panel.page(Eigen::Vector2d(panel.low.x(), y.at));
    canvas.text(at + Eigen::Vector2d(-8.0, 4.5), y.text, text_size, TextAnchor::end, ink);
  }
  canvas.lines({panel.page(Canvas::Line{
                   {panel.low.x(), panel.high.y()}, panel.low, {panel.high.x(), panel.low.y()}})},
               ink, 1.0);
  canvas.text(panel.top_left + Eigen::Vector2d(panel.size.x() / 2.0, panel.size.y() + 40.0), x_name,
              text_size, TextAnchor::middle, ink);
  canvas.text(panel.top_left + Eigen::Vector2d(0.0, -10.0), y_name, text_size, TextAnchor::start,
              ink);
}

void draw_legend(Canvas& canvas, const Eigen::Vector2d& right,
                 const std::vector<LegendEntry>& entries) {
  double x = right.x() + 2.0 * legend_gap;
  for (const LegendEntry& entry : entries) x -= legend_entry_width(entry) + 2.0 * legend_gap;
  for (const LegendEntry& entry : entries) {
    const double y = right.y() - 4.5;
    canvas.lines({{{x, y}, {x + legend_sample, y}}}, entry.colour, entry.width);
    canvas.text({x + legend_sample + legend_gap, right.y()}, entry.name, text_size,
                TextAnchor::start, ink);
    x += legend_entry_width(entry) + 2.0 * legend_gap;
  }
}

std::vector<Canvas::Line> broken_at_gaps(const std::vector<double>& times,
                                         const std::vector<Eigen::Vector2d>& points) {
  if (times.size() < 2) return {};
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  const double longest = gap_intervals * median(intervals);
  std::vector<Canvas::Line> lines(1, {points[0]});
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (intervals[i - 1] > longest) lines.emplace_back();
    lines.back().push_back(points[i]);
  }
  return lines;
}

}  // namespace dkp_slam

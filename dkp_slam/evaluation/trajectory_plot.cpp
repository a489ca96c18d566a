#include "dkp_slam/evaluation/trajectory_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace dkp_slam {
namespace {

constexpr Colour ink{60, 60, 60};
constexpr Colour faint{226, 226, 226};
constexpr Colour truth_colour{40, 40, 40};
constexpr Colour estimate_colour{31, 110, 190};
constexpr Colour error_colour{214, 70, 60};
constexpr double text_size = 13.0;
constexpr double title_size = 16.0;
// A path is broken where its poses lie this many usual intervals apart: frames were lost there.
constexpr double gap_intervals = 4.0;

/// A rectangle of the page with data coordinates, y up.
struct Panel {
  Eigen::Vector2d top_left;  // points
  Eigen::Vector2d size;
  Eigen::Vector2d low;  // data
  Eigen::Vector2d high;

  Eigen::Vector2d page(const Eigen::Vector2d& data) const {
    const Eigen::Vector2d share = (data - low).cwiseQuotient(high - low);
    return top_left + Eigen::Vector2d(share.x() * size.x(), (1.0 - share.y()) * size.y());
  }
  Canvas::Line page(const Canvas::Line& data) const {
    Canvas::Line line;
    line.reserve(data.size());
    for (const Eigen::Vector2d& point : data) line.push_back(page(point));
    return line;
  }
};

/// Digits after the point that tell these ticks apart.
int digits_for(const std::vector<double>& values) {
  if (values.size() < 2) return 2;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(values[1] - values[0]) - 1e-9)), 0, 9);
}

void draw_axes(Canvas& canvas, const Panel& panel, int x_ticks, int y_ticks,
               const std::string& x_name, const std::string& y_name) {
  const std::vector<double> xs = ticks(panel.low.x(), panel.high.x(), x_ticks);
  const std::vector<double> ys = ticks(panel.low.y(), panel.high.y(), y_ticks);
  std::vector<Canvas::Line> grid;
  for (double x : xs) {
    grid.push_back(panel.page(Canvas::Line{{x, panel.low.y()}, {x, panel.high.y()}}));
  }
  for (double y : ys) {
    grid.push_back(panel.page(Canvas::Line{{panel.low.x(), y}, {panel.high.x(), y}}));
  }
  canvas.lines(grid, faint, 0.8);
  for (double x : xs) {
    const Eigen::Vector2d at = panel.page(Eigen::Vector2d(x, panel.low.y()));
    canvas.text(at + Eigen::Vector2d(0.0, 19.0), fmt::format("{:.{}f}", x, digits_for(xs)),
                text_size, TextAnchor::middle, ink);
  }
  for (double y : ys) {
    const Eigen::Vector2d at = panel.page(Eigen::Vector2d(panel.low.x(), y));
    canvas.text(at + Eigen::Vector2d(-8.0, 4.5), fmt::format("{:.{}f}", y, digits_for(ys)),
                text_size, TextAnchor::end, ink);
  }
  canvas.lines({panel.page(Canvas::Line{
                   {panel.low.x(), panel.high.y()}, panel.low, {panel.high.x(), panel.low.y()}})},
               ink, 1.0);
  canvas.text(panel.top_left + Eigen::Vector2d(panel.size.x() / 2.0, panel.size.y() + 40.0), x_name,
              text_size, TextAnchor::middle, ink);
  canvas.text(panel.top_left + Eigen::Vector2d(0.0, -10.0), y_name, text_size, TextAnchor::start,
              ink);
}

struct LegendEntry {
  std::string name;
  Colour colour;
  double width;
};

/// One row that ends at about `right`.
void draw_legend(Canvas& canvas, const Eigen::Vector2d& right,
                 const std::vector<LegendEntry>& entries) {
  constexpr double sample = 24.0;
  constexpr double gap = 8.0;
  // The canvas does not measure text; this is wide enough for both of its fonts.
  const auto width = [](const LegendEntry& entry) {
    return 7.6 * static_cast<double>(entry.name.size()) + sample + gap;
  };
  double x = right.x() + 2.0 * gap;
  for (const LegendEntry& entry : entries) x -= width(entry) + 2.0 * gap;
  for (const LegendEntry& entry : entries) {
    const double y = right.y() - 4.5;
    canvas.lines({{{x, y}, {x + sample, y}}}, entry.colour, entry.width);
    canvas.text({x + sample + gap, right.y()}, entry.name, text_size, TextAnchor::start, ink);
    x += width(entry) + 2.0 * gap;
  }
}

/// Points with their times, broken into lines where poses are missing.
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

/// The part of the paths that is drawn, in the truth's world frame.
struct Paths {
  std::vector<double> truth_times, estimate_times;
  std::vector<Eigen::Vector3d> truth, estimate;
  std::vector<std::array<Eigen::Vector3d, 2>> differences;
};

Paths paths_of(std::span<const StampedPose> truth, std::span<const StampedPose> estimate,
               const AbsoluteError& error, const AssociationOptions& association) {
  Paths paths;
  const double begin = estimate.front().timestamp + association.offset - association.max_difference;
  const double end = estimate.back().timestamp + association.offset + association.max_difference;
  for (const StampedPose& pose : truth) {
    if (pose.timestamp < begin || pose.timestamp > end) continue;
    paths.truth_times.push_back(pose.timestamp);
    paths.truth.push_back(pose.world_from_camera.translation);
  }
  for (const StampedPose& pose : estimate) {
    paths.estimate_times.push_back(pose.timestamp);
    paths.estimate.push_back(error.truth_from_estimate * pose.world_from_camera.translation);
  }
  for (const PoseMatch& match : error.matches) {
    paths.differences.push_back(
        {truth[match.truth].world_from_camera.translation, paths.estimate[match.estimate]});
  }
  return paths;
}

/// The two axes, in their order, along which the paths are widest, and the middle and the extents.
struct View {
  int across = 0, up = 1;
  Eigen::Vector3d middle, extent;

  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return {p[across], p[up]}; }
  std::vector<Eigen::Vector2d> operator()(const std::vector<Eigen::Vector3d>& points) const {
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector3d& point : points) seen.push_back((*this)(point));
    return seen;
  }
};

View widest_view(const Paths& paths) {
  Eigen::Vector3d low = paths.estimate.front();
  Eigen::Vector3d high = low;
  for (const auto* points : {&paths.truth, &paths.estimate}) {
    for (const Eigen::Vector3d& point : *points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  View view;
  view.middle = 0.5 * (low + high);
  view.extent = high - low;
  Eigen::Index narrowest = 0;
  view.extent.reverse().minCoeff(&narrowest);  // of equal axes z is left out first
  narrowest = 2 - narrowest;
  view.across = narrowest == 0 ? 1 : 0;
  view.up = narrowest == 2 ? 1 : 2;
  return view;
}

void draw_paths(Canvas& canvas, const Paths& paths) {
  const View view = widest_view(paths);
  constexpr double width = plot_width - 72.0 - 24.0;
  Panel panel{{72.0, 84.0}, {width, width * 2.0 / 3.0}, {}, {}};
  // One scale for both axes, with a margin around the paths; a camera at rest still gets a view.
  const Eigen::Vector2d extent = view(view.extent).cwiseMax(1e-3) * 1.1;
  const double metres_per_point = extent.cwiseQuotient(panel.size).maxCoeff();
  panel.low = view(view.middle) - 0.5 * metres_per_point * panel.size;
  panel.high = view(view.middle) + 0.5 * metres_per_point * panel.size;

  constexpr std::array<const char*, 3> names = {"x [m]", "y [m]", "z [m]"};
  // As many ticks for their length on one axis as on the other, so that both have the same step.
  draw_axes(canvas, panel, 12, 8, names[static_cast<std::size_t>(view.across)],
            names[static_cast<std::size_t>(view.up)]);
  const auto draw = [&](std::vector<Canvas::Line> lines, Colour colour, double width) {
    for (Canvas::Line& line : lines) line = panel.page(line);
    canvas.lines(lines, colour, width);
  };
  std::vector<Canvas::Line> differences;
  for (const auto& [true_point, estimated_point] : paths.differences) {
    differences.push_back({view(true_point), view(estimated_point)});
  }
  draw(broken_at_gaps(paths.truth_times, view(paths.truth)), truth_colour, 1.2);
  draw(differences, error_colour, 0.8);
  draw(broken_at_gaps(paths.estimate_times, view(paths.estimate)), estimate_colour, 1.4);
  draw_legend(canvas, {plot_width - 24.0, 74.0},
              {{"ground truth", truth_colour, 1.6},
               {"estimate", estimate_colour, 2.0},
               {"difference", error_colour, 1.6}});
}

void draw_error_over_time(Canvas& canvas, std::span<const StampedPose> estimate,
                          const AbsoluteError& error) {
  std::vector<double> times;
  std::vector<Eigen::Vector2d> points;
  const double start = estimate[error.matches.front().estimate].timestamp;
  for (std::size_t i = 0; i < error.matches.size(); ++i) {
    times.push_back(estimate[error.matches[i].estimate].timestamp - start);
    points.emplace_back(times.back(), error.errors[i]);
  }
  const double highest = std::max(1.1 * error.statistics.max, 1e-6);
  const Panel panel{
      {72.0, 660.0}, {plot_width - 72.0 - 24.0, 140.0}, {0.0, 0.0}, {times.back(), highest}};
  draw_axes(canvas, panel, 10, 4, "time [s]", "error [m]");
  std::vector<Canvas::Line> lines = broken_at_gaps(times, points);
  for (Canvas::Line& line : lines) line = panel.page(line);
  canvas.lines(lines, error_colour, 1.2);
  const double rmse = error.statistics.rmse;
  canvas.lines({panel.page(Canvas::Line{{0.0, rmse}, {times.back(), rmse}})}, ink, 1.0);
  draw_legend(canvas, {plot_width - 24.0, 650.0},
              {{"error", error_colour, 1.6}, {"RMSE", ink, 1.0}});
}

}  // namespace

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

void draw_trajectories(Canvas& canvas, std::span<const StampedPose> truth,
                       std::span<const StampedPose> estimate, const AbsoluteError& error,
                       const AssociationOptions& association, const std::string& title) {
  canvas.text({24.0, 36.0}, title, title_size, TextAnchor::start, ink);
  draw_paths(canvas, paths_of(truth, estimate, error, association));
  draw_error_over_time(canvas, estimate, error);
}

}  // namespace dkp_slam

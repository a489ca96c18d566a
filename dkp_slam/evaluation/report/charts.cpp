#include "dkp_slam/evaluation/report/charts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace dkp_slam {
namespace {

using namespace chart;

// Room for what stands around a panel, points.
constexpr double left = 62.0, right = 14.0, above = 42.0, below = 46.0;
constexpr double path_width = 1.6;
// Points between two ticks.
constexpr double tick_distance_x = 70.0, tick_distance_y = 38.0;
// Estimates are shown this far beyond the true path, in units of its extent, and at least 5 cm.
constexpr double stray_factor = 0.75;
constexpr double stray_least = 0.05;
// From this ratio on the smaller error could not be seen on a linear axis.
constexpr double ratio_for_logarithm = 4.0;
// Smaller errors are nothing that anyone could measure, metres.
constexpr double least_error = 1e-4;

/// The panel's place within the box, below the legend and the name of the y axis.
ChartBox inner(const ChartBox& box) {
  return {box.top_left + Eigen::Vector2d(left, above),
          box.size - Eigen::Vector2d(left + right, above + below)};
}

void draw_legend_above(Canvas& canvas, const ChartBox& box,
                       const std::vector<LegendEntry>& entries) {
  draw_legend(canvas, box.top_left + Eigen::Vector2d(box.size.x() - right, 14.0), entries);
}

int ticks_along(double length, double distance) {
  return std::max(3, static_cast<int>(length / distance));
}

std::vector<Tick> x_ticks_of(const Panel& panel) {
  return round_ticks(panel.low.x(), panel.high.x(), ticks_along(panel.size.x(), tick_distance_x));
}
std::vector<Tick> y_ticks_of(const Panel& panel) {
  return round_ticks(panel.low.y(), panel.high.y(), ticks_along(panel.size.y(), tick_distance_y));
}

/// Lines on the page, without the points outside the panel.
std::vector<Canvas::Line> within(const Panel& panel, const std::vector<Canvas::Line>& lines) {
  std::vector<Canvas::Line> result;
  for (const Canvas::Line& line : lines) {
    result.emplace_back();
    for (const Eigen::Vector2d& point : line) {
      const bool inside =
          (point.array() >= panel.low.array()).all() && (point.array() <= panel.high.array()).all();
      if (inside) {
        result.back().push_back(panel.page(point));
      } else if (!result.back().empty()) {
        result.emplace_back();
      }
    }
  }
  return result;
}

struct SeenPath {
  std::vector<double> times;
  std::vector<Eigen::Vector2d> points;
};

SeenPath seen_truth(std::span<const StampedPose> truth, const View& view) {
  SeenPath seen;
  for (const StampedPose& pose : truth) {
    seen.times.push_back(pose.timestamp);
    seen.points.push_back(view(pose.world_from_camera.translation));
  }
  return seen;
}

SeenPath seen_estimate(const ScoredPath& path, const View& view) {
  SeenPath seen;
  for (const StampedPose& pose : path.estimate) {
    seen.times.push_back(pose.timestamp);
    seen.points.push_back(
        view(path.error.truth_from_estimate * pose.world_from_camera.translation));
  }
  return seen;
}

Panel panel_around(const ChartBox& place, const SeenPath& truth,
                   const std::vector<SeenPath>& estimates) {
  Eigen::Vector2d low = truth.points.front(), high = low;
  for (const Eigen::Vector2d& point : truth.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double stray = std::max(stray_factor * (high - low).maxCoeff(), stray_least);
  const Eigen::Vector2d lowest = low.array() - stray, highest = high.array() + stray;
  for (const SeenPath& path : estimates) {
    for (const Eigen::Vector2d& point : path.points) {
      low = low.cwiseMin(point.cwiseMax(lowest));
      high = high.cwiseMax(point.cwiseMin(highest));
    }
  }
  return equal_panel(place.top_left, place.size, low, high);
}

/// Times since `start` and errors of a path, broken where frames are missing.
std::vector<Canvas::Line> error_lines(const ScoredPath& path, double start) {
  std::vector<double> times;
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < path.error.matches.size(); ++i) {
    times.push_back(path.estimate[path.error.matches[i].estimate].timestamp - start);
    points.emplace_back(times.back(), path.error.errors[i]);
  }
  return broken_at_gaps(times, points);
}

std::vector<Tick> logarithmic_ticks(double low, double high) {
  std::vector<Tick> result;
  const bool fine = high - low < 2.5;
  for (int decade = static_cast<int>(std::floor(low)); decade <= static_cast<int>(high); ++decade) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1.0 && !fine) continue;
      const double value = factor * std::pow(10.0, decade), at = std::log10(value);
      if (at < low - 1e-9 || at > high + 1e-9) continue;
      result.push_back({at, fmt::format("{:g}", value)});
    }
  }
  return result;
}

}  // namespace

void draw_paths_from_above(Canvas& canvas, const ChartBox& box, std::span<const StampedPose> truth,
                           std::span<const ScoredPath> paths) {
  if (truth.empty() || paths.empty()) return;
  const View view{0, 1};
  const SeenPath true_path = seen_truth(truth_during(truth, paths), view);
  std::vector<SeenPath> estimates;
  std::vector<LegendEntry> entries{{"true path", truth_colour, 2.6}};
  for (const ScoredPath& path : paths) {
    estimates.push_back(seen_estimate(path, view));
    entries.push_back({path.name, path.colour, 2.4});
  }
  if (true_path.points.empty()) return;
  const Panel panel = panel_around(inner(box), true_path, estimates);
  draw_axes(canvas, panel, x_ticks_of(panel), y_ticks_of(panel), view.across_name(),
            view.up_name());
  canvas.lines(within(panel, broken_at_gaps(true_path.times, true_path.points)), truth_colour,
               path_width + 0.6);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    canvas.lines(within(panel, broken_at_gaps(estimates[i].times, estimates[i].points)),
                 paths[i].colour, path_width);
  }
  draw_legend_above(canvas, box, entries);
}

void draw_errors_over_time(Canvas& canvas, const ChartBox& box, std::span<const ScoredPath> paths) {
  if (paths.empty()) return;
  const auto first_stamp = [](const ScoredPath& path) {
    return path.estimate[path.error.matches.front().estimate].timestamp;
  };
  double start = first_stamp(paths.front()), length = 0.0, highest = 0.0;
  double best = paths.front().error.statistics.rmse, worst = best;
  for (const ScoredPath& path : paths) start = std::min(start, first_stamp(path));
  std::vector<LegendEntry> entries;
  for (const ScoredPath& path : paths) {
    const double end = path.estimate[path.error.matches.back().estimate].timestamp;
    length = std::max(length, end - start);
    highest = std::max(highest, path.error.statistics.max);
    best = std::min(best, path.error.statistics.rmse);
    worst = std::max(worst, path.error.statistics.rmse);
    entries.push_back({path.name, path.colour, 2.4});
  }
  const bool logarithmic = worst > ratio_for_logarithm * std::max(best, least_error);
  const ChartBox place = inner(box);
  Panel panel{place.top_left, place.size, {0.0, 0.0}, {length, std::max(1.05 * highest, 1e-6)}};
  if (logarithmic) {
    // A tenth of the best run's error: what lies below is drawn there.
    panel.low.y() = std::log10(std::max(0.1 * best, least_error));
    panel.high.y() = std::log10(1.1 * highest);
  }
  draw_axes(canvas, panel, x_ticks_of(panel),
            logarithmic ? logarithmic_ticks(panel.low.y(), panel.high.y()) : y_ticks_of(panel),
            "time [s]", logarithmic ? "error [m], logarithmic" : "error [m]");
  for (const ScoredPath& path : paths) {
    std::vector<Canvas::Line> lines = error_lines(path, start);
    for (Canvas::Line& line : lines) {
      for (Eigen::Vector2d& point : line) {
        if (logarithmic) point.y() = std::max(panel.low.y(), std::log10(point.y() + 1e-12));
        point = panel.page(point);
      }
    }
    canvas.lines(lines, path.colour, path_width);
  }
  draw_legend_above(canvas, box, entries);
}

}  // namespace dkp_slam

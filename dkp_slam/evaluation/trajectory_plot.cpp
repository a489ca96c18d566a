#include "dkp_slam/evaluation/trajectory_plot.h"

#include <algorithm>
#include <array>

namespace dkp_slam {
namespace {

using namespace chart;

constexpr double title_size = 16.0;

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

/// The smallest box around the paths.
struct Bounds {
  Eigen::Vector3d low, high;
};

Bounds bounds_of(const Paths& paths) {
  Bounds bounds{paths.estimate.front(), paths.estimate.front()};
  for (const auto* points : {&paths.truth, &paths.estimate}) {
    for (const Eigen::Vector3d& point : *points) {
      bounds.low = bounds.low.cwiseMin(point);
      bounds.high = bounds.high.cwiseMax(point);
    }
  }
  return bounds;
}

/// The two axes, in their order, along which the paths are widest.
View widest_view(const Bounds& bounds) {
  Eigen::Index narrowest = 0;
  // Of equal axes z is left out first.
  (bounds.high - bounds.low).reverse().minCoeff(&narrowest);
  narrowest = 2 - narrowest;
  return {narrowest == 0 ? 1 : 0, narrowest == 2 ? 1 : 2};
}

void draw_paths(Canvas& canvas, const Paths& paths) {
  const Bounds bounds = bounds_of(paths);
  const View view = widest_view(bounds);
  constexpr double width = plot_width - 72.0 - 24.0;
  const Panel panel =
      equal_panel({72.0, 84.0}, {width, width * 2.0 / 3.0}, view(bounds.low), view(bounds.high));
  // As many ticks for their length on one axis as on the other, so that both have the same step.
  draw_axes(canvas, panel, round_ticks(panel.low.x(), panel.high.x(), 12),
            round_ticks(panel.low.y(), panel.high.y(), 8), view.across_name(), view.up_name());
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
  draw_axes(canvas, panel, round_ticks(0.0, times.back(), 10), round_ticks(0.0, highest, 4),
            "time [s]", "error [m]");
  std::vector<Canvas::Line> lines = broken_at_gaps(times, points);
  for (Canvas::Line& line : lines) line = panel.page(line);
  canvas.lines(lines, error_colour, 1.2);
  const double rmse = error.statistics.rmse;
  canvas.lines({panel.page(Canvas::Line{{0.0, rmse}, {times.back(), rmse}})}, ink, 1.0);
  draw_legend(canvas, {plot_width - 24.0, 650.0},
              {{"error", error_colour, 1.6}, {"RMSE", ink, 1.0}});
}

}  // namespace

void draw_trajectories(Canvas& canvas, std::span<const StampedPose> truth,
                       std::span<const StampedPose> estimate, const AbsoluteError& error,
                       const AssociationOptions& association, const std::string& title) {
  canvas.text({24.0, 36.0}, title, title_size, TextAnchor::start, ink);
  draw_paths(canvas, paths_of(truth, estimate, error, association));
  draw_error_over_time(canvas, estimate, error);
}

}  // namespace dkp_slam

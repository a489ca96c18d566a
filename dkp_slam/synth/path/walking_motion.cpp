#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include "dkp_slam/synth/path/motion.h"
#include "dkp_slam/synth/path/pose_spline.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double spacing = 0.02;        // metres between points of the line
constexpr double rounding = 0.40;       // metres: cuts corners by about half of it
constexpr double look_ahead = 0.8;      // metres: a turn is begun before the corner
constexpr double camera_height = 1.40;  // metres
constexpr double pitch = -0.12;         // radians: the floor ahead and the far wall both in view
constexpr double step_frequency = 1.7;  // Hz, of a slow walker's steps
constexpr double bob = 0.012;           // metres up and down with each step
constexpr double sway = 0.012;          // metres aside with every second step
constexpr double path_knot_interval = 0.1;  // seconds

/// A closed line of points at equal distances.
class Loop {
 public:
  explicit Loop(std::vector<Vector2d> corners) {
    assert(corners.size() >= 3);
    points_ = rounded(divided(corners));
    points_ = divided(points_);
  }

  double length() const { return spacing * static_cast<double>(points_.size()); }
  Vector2d at(double way) const {
    const double place = way / spacing, whole = std::floor(place);
    const auto i = static_cast<long>(whole);
    const double share = place - whole;
    return (1.0 - share) * point(i) + share * point(i + 1);
  }

 private:
  const Vector2d& point(long i) const {
    const auto count = static_cast<long>(points_.size());
    return points_[static_cast<std::size_t>((i % count + count) % count)];
  }

  /// Points about `spacing` apart, a whole number of them around the line.
  static std::vector<Vector2d> divided(const std::vector<Vector2d>& line) {
    double around = 0.0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      around += (line[(i + 1) % line.size()] - line[i]).norm();
    }
    const auto count = static_cast<std::size_t>(std::max(std::round(around / spacing), 3.0));
    const double step = around / static_cast<double>(count);
    std::vector<Vector2d> points;
    double passed = 0.0;
    for (std::size_t i = 0; i < line.size() && points.size() < count; ++i) {
      const Vector2d side = line[(i + 1) % line.size()] - line[i];
      const double end = passed + side.norm();
      while (points.size() < count && static_cast<double>(points.size()) * step < end) {
        const double along = (static_cast<double>(points.size()) * step - passed) / side.norm();
        points.push_back(line[i] + along * side);
      }
      passed = end;
    }
    return points;
  }

  /// Each point the mean of those around it, by a Gaussian of `rounding`.
  static std::vector<Vector2d> rounded(const std::vector<Vector2d>& line) {
    const auto reach = static_cast<long>(3.0 * rounding / spacing);
    const auto count = static_cast<long>(line.size());
    std::vector<Vector2d> points;
    for (long i = 0; i < count; ++i) {
      Vector2d sum = Vector2d::Zero();
      double weights = 0.0;
      for (long k = -reach; k <= reach; ++k) {
        const double z = static_cast<double>(k) * spacing / rounding;
        const double weight = std::exp(-0.5 * z * z);
        sum += weight * line[static_cast<std::size_t>(((i + k) % count + count) % count)];
        weights += weight;
      }
      points.push_back(sum / weights);
    }
    return points;
  }

  std::vector<Vector2d> points_;
};

/// The walker's camera without its sway, `way` metres from the start.
Se3 carried(const Loop& loop, double way) {
  const Vector2d here = loop.at(way), there = loop.at(way + look_ahead);
  const Vector2d ahead = there - here;
  return {camera_view(std::atan2(-ahead.x(), ahead.y()), pitch, 0.0),
          Vector3d(here.x(), here.y(), camera_height)};
}

}  // namespace

double walking_length(const std::vector<Vector2d>& way_points) { return Loop(way_points).length(); }

CameraPath walking_motion(const std::vector<Vector2d>& way_points, std::uint64_t seed) {
  const Loop loop(way_points);
  // A whole number of knots goes around, so the speed is a little off the named one.
  const auto knots = static_cast<std::size_t>(
      std::ceil(loop.length() / (camera_walking_speed * path_knot_interval)));
  std::vector<Se3> path;
  for (std::size_t i = 0; i < knots; ++i) {
    path.push_back(carried(loop, loop.length() * static_cast<double>(i) / double(knots)));
  }
  const auto spline = std::make_shared<const PoseSpline>(std::move(path), path_knot_interval, true);
  // The hands' own trembling; its mean is at rest.
  const CameraPath hands = hand_motion(SyntheticMotion::still, seed, {Vector3d::Zero(), 0.0, 0.0});
  const Se3 level = Se3(camera_view(0.0, 0.0, 0.0), Vector3d::Zero()).inverse();
  return [=](double time) {
    const double t = from_rest(time);
    const double started = std::clamp(0.5 * t, 0.0, 1.0);
    const double strength = started * started * (3.0 - 2.0 * started);
    const double phase = 2.0 * std::numbers::pi * step_frequency * t;
    Se3 steps;
    steps.translation.x() = strength * sway * std::sin(0.5 * phase);
    steps.translation.y() = strength * bob * std::cos(phase);
    return spline->at(t) * steps * (level * hands(time));
  };
}

}  // namespace dkp_slam

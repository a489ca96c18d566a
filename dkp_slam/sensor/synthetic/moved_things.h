#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/synthetic/actor.h"
#include "dkp_slam/sensor/synthetic/figure.h"

namespace dkp_slam {

/// A stay of a figure at a place, seconds.
struct Stay {
  double arrives = 0.0, leaves = 0.0;
};

/// From 0 to 1 between two moments, at rest before and after.
double eased(double time, double from, double to);

/// The figure's first stay within 5 cm of a place (x, y; metres) that begins at `after` or later,
/// to a hundredth of a second. Throws `Error` where there is none within three minutes: a mistake
/// in a script.
Stay stay_at(const Figure& figure, const Eigen::Vector2d& place, double after = 0.0);

/// A thing that a figure pushes from one moment to another: it keeps its place before the figure's
/// feet (`root_from_thing`), and stays where it is before and after.
RigidActor::Motion pushed(std::shared_ptr<const Figure> figure, const Se3& root_from_thing,
                          double from, double to);

/// A thing that stands at `rest`, is taken into the figure's hands in the second before `from`
/// (`hands_from_thing` then), and is put to `goal` in the second after `to`.
RigidActor::Motion carried(std::shared_ptr<const Figure> figure, const Se3& hands_from_thing,
                           const Se3& rest, const Se3& goal, double from, double to);

/// A thing that rolls by itself along way points on the floor (x, y; metres) and back again, over
/// and over, its front (-y) ahead: `speed` metres a second, with a pause of `pause` seconds at
/// either end, first of all at the first point. Corners are rounded.
RigidActor::Motion rolling(const std::vector<Eigen::Vector2d>& way_points, double speed,
                           double pause);

/// A robot on wheels, 1.1 m high, front towards -y.
std::vector<Mesh> robot(cv::RNG& rng);

}  // namespace dkp_slam

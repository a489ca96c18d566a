#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/synth/figure/figure.h"
#include "dkp_slam/synth/mesh/actor.h"

namespace dkp_slam {

/// A stay of a figure at a place, seconds.
struct Stay {
  double arrives = 0.0, leaves = 0.0;
};

/// From 0 to 1 between two moments, at rest before and after.
double eased(double time, double from, double to);

/// Where a figure stands at a time (x, y; metres): `Figure::root`'s or its script's place.
using PlaceOverTime = std::function<Eigen::Vector2d(double time)>;

/// The first stay within 5 cm of a place that begins at `after` or later, to a hundredth of a
/// second. Throws `Error` where there is none within three minutes: a mistake in a script.
Stay stay_at(const PlaceOverTime& figure, const Eigen::Vector2d& place, double after = 0.0);

/// A thing that a figure pushes from one moment to another: it keeps its place before the figure's
/// feet (`root_from_thing`), and stays where it is before and after.
RigidActor::Motion pushed(std::shared_ptr<const Figure> figure, const Se3& root_from_thing,
                          double from, double to);

/// From one place to another in somebody's hands.
struct Carriage {
  double from = 0.0, to = 0.0;  ///< seconds; taken up in the second before, put down in that after
  Se3 start, goal;              ///< world_from_thing before and after
};

/// A thing that is carried now and then; `hands_from_thing`: in the figure's hands. `carriages` in
/// the order of time, more than two seconds apart, at least one.
RigidActor::Motion carried(std::shared_ptr<const Figure> figure, const Se3& hands_from_thing,
                           std::vector<Carriage> carriages);

/// A thing that rolls by itself along way points on the floor (x, y; metres) and back again, over
/// and over, its front (-y) ahead on the way there: `speed` metres a second on the average, first
/// at `departure`, with a pause of `pause` seconds at either end. Corners are rounded.
RigidActor::Motion rolling(const std::vector<Eigen::Vector2d>& way_points, double speed,
                           double departure, double pause);

/// A robot on wheels, 1.1 m high, front towards -y.
std::vector<Mesh> robot(cv::RNG& rng);

}  // namespace dkp_slam

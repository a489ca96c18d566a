#include "dkp_slam/synth/moved_things.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/room/furniture.h"
#include "dkp_slam/synth/room/furniture_kit.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Se3 between(const Se3& a, const Se3& b, double share) {
  return {a.rotation.slerp(share, b.rotation),
          (1.0 - share) * a.translation + share * b.translation};
}

/// Stands on the floor, front (-y) along `ahead`.
Se3 on_floor(const Vector2d& place, const Vector2d& ahead) {
  const double heading = std::atan2(ahead.y(), ahead.x()) + 0.5 * std::numbers::pi;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(heading, Vector3d::UnitZ())),
          Vector3d(place.x(), place.y(), 0.0)};
}

}  // namespace

double eased(double time, double from, double to) {
  const double u = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

Stay stay_at(const PlaceOverTime& figure, const Vector2d& place, double after) {
  constexpr double step = 0.01, longest = 180.0, near = 0.05;
  const auto is_there = [&](double time) { return (figure(time) - place).norm() < near; };
  Stay stay{after, after};
  while (!is_there(stay.arrives)) {
    stay.arrives += step;
    if (stay.arrives > after + longest) {
      throw Error(fmt::format("scenario: a figure never comes to ({:.2f}, {:.2f}) after {:.1f} s",
                              place.x(), place.y(), after));
    }
  }
  stay.leaves = stay.arrives;
  while (is_there(stay.leaves) && stay.leaves < stay.arrives + longest) stay.leaves += step;
  return stay;
}

RigidActor::Motion pushed(std::shared_ptr<const Figure> figure, const Se3& root_from_thing,
                          double from, double to) {
  return [figure = std::move(figure), root_from_thing, from, to](double time) {
    return figure->root(std::clamp(time, from, to)) * root_from_thing;
  };
}

RigidActor::Motion carried(std::shared_ptr<const Figure> figure, const Se3& hands_from_thing,
                           std::vector<Carriage> carriages) {
  return [=, figure = std::move(figure), carriages = std::move(carriages)](double time) {
    // The carriage that is on, or else the one before: the thing then rests at its goal.
    std::size_t i = 0;
    while (i + 1 < carriages.size() && time > carriages[i + 1].from - 1.0) ++i;
    const Carriage& c = carriages[i];
    if (time <= c.from - 1.0) return c.start;
    if (time >= c.to + 1.0) return c.goal;
    const Se3 held = figure->hands(time) * hands_from_thing;
    if (time < c.from) return between(c.start, held, eased(time, c.from - 1.0, c.from));
    return between(held, c.goal, eased(time, c.to, c.to + 1.0));
  };
}

RigidActor::Motion rolling(const std::vector<Vector2d>& way_points, double speed, double departure,
                           double pause) {
  constexpr double rounding = 0.25;  // metres before and behind a corner
  std::vector<double> ways = {0.0};
  for (std::size_t i = 1; i < way_points.size(); ++i) {
    ways.push_back(ways.back() + (way_points[i] - way_points[i - 1]).norm());
  }
  const auto on_line = [=](double way) -> Vector2d {
    std::size_t i = 1;
    while (i + 1 < ways.size() && way > ways[i]) ++i;
    const double share = (way - ways[i - 1]) / (ways[i] - ways[i - 1]);
    // Beyond the ends it goes straight on, so that the heading is known there too.
    return way_points[i - 1] + share * (way_points[i] - way_points[i - 1]);
  };
  const double length = ways.back(), ride = length / speed;
  return [=](double time) {
    const double phase = std::fmod(std::max(time - departure, 0.0), 2.0 * (ride + pause));
    const bool back = phase >= ride + pause;
    const double since = back ? phase - ride - pause : phase;
    const double done = length * eased(since, 0.0, ride);
    const double way = back ? length - done : done;
    const Vector2d rear = on_line(way - rounding), front = on_line(way + rounding);
    // It does not turn about for the way back.
    return on_floor(0.25 * rear + 0.5 * on_line(way) + 0.25 * front, front - rear);
  };
}

std::vector<Mesh> robot(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material rubber = kit.smooth({45, 45, 45}), shell = kit.smooth({190, 205, 210});
  const Material cover = kit.smooth(room_colour(rng, 60, 200));
  for (const double x : {-0.20, 0.20}) {
    for (const double y : {-0.18, 0.18}) kit.block({x, y, 0.061}, {0.05, 0.12, 0.12}, rubber);
  }
  kit.cushion({0.0, 0.0, 0.25}, {0.46, 0.52, 0.28}, 0.05, cover);
  kit.turned({0.0, 0.12, 0.38}, {{0.05, 0.60}, {0.05, 0.30}, {0.07, 0.0}}, 16, shell);
  kit.block({0.0, 0.0, 0.62}, {0.38, 0.38, 0.03}, shell);
  kit.place(cardboard_box(rng, {0.28, 0.24, 0.18}), {0.0, -0.04, 0.636});
  kit.block({0.0, 0.10, 1.02}, {0.36, 0.06, 0.24}, rubber);
  const Vector3d x(0.32, 0.0, 0.0), down(0.0, 0.0, -0.20);
  kit.picture({-0.16, 0.069, 1.12}, x, down, make_texture(browser_print(rng, {256, 160})), 0.6F);
  kit.picture({-0.19, -0.262, 0.34}, {0.38, 0.0, 0.0}, {0.0, 0.0, -0.16},
              make_texture(any_poster_print(rng, {152, 64})));
  return kit.meshes;
}

}  // namespace dkp_slam

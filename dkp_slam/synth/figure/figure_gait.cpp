#include "dkp_slam/synth/figure/figure_gait.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dkp_slam/synth/figure/figure_loft.h"

namespace dkp_slam {
namespace {

// In steps (from one foot's landing to the other's), after Perry, "Gait Analysis" (1992): a foot
// is in the air for 40% of two steps, and lands before the body is over it.
constexpr double in_the_air = 0.80;
constexpr double ahead = 0.45;
constexpr double toe_out = 0.10;                  // radians
constexpr double turn_of_a_step = 0.70;           // radians
constexpr double normal_stride = 1.2;             // metres, of a foot, for the full roll
constexpr double heel_up = 0.85, toes_up = 0.30;  // radians
constexpr double flat_after = 0.13;               // seconds from the heel's landing

/// How many steps have been made at the times of a fine grid.
struct StepCount {
  double from, spacing;
  std::vector<double> steps;

  double time_of(double count) const {
    const auto after = std::lower_bound(steps.begin(), steps.end(), count);
    if (after == steps.begin()) return from;
    const auto i = static_cast<std::size_t>(after - steps.begin());
    if (after == steps.end()) return from + spacing * static_cast<double>(steps.size() - 1);
    const double share = (count - steps[i - 1]) / (steps[i] - steps[i - 1]);
    return from + spacing * (static_cast<double>(i - 1) + share);
  }
};

StepCount count_steps(const FigureScript& script, const FigureScript::Interval& walk, double step,
                      double usual_speed) {
  StepCount count{walk.from, 0.02, {0.0}};
  const auto intervals = static_cast<std::size_t>(std::ceil((walk.to - walk.from) / 0.02));
  count.spacing = (walk.to - walk.from) / static_cast<double>(intervals);
  Eigen::Vector2d place = script.place(walk.from);
  double heading = script.heading(walk.from);
  for (std::size_t i = 1; i <= intervals; ++i) {
    const double time = walk.from + count.spacing * static_cast<double>(i);
    const Eigen::Vector2d next_place = script.place(time);
    const double next_heading = script.heading(time);
    const double speed = (next_place - place).norm() / count.spacing;
    const double turning = std::abs(next_heading - heading) / count.spacing;
    // Slow walkers' steps are both shorter and rarer.
    const double rate = std::hypot(std::sqrt(speed * usual_speed) / step, turning / turn_of_a_step);
    count.steps.push_back(count.steps.back() + count.spacing * (rate + 0.15));
    place = next_place;
    heading = next_heading;
  }
  return count;
}

}  // namespace

FigureGait::FigureGait(const FigureScript& script, double step, double speed, double apart,
                       bool left_first)
    : apart_(apart) {
  constexpr double always = -std::numeric_limits<double>::infinity();
  for (const int side : {1, -1}) {
    Footfall start = standing(script, side, 0.0);
    start.lift = start.land = always;
    (side > 0 ? left_ : right_).push_back(start);
  }
  for (const FigureScript::Interval& walk : script.walks()) {
    step_through(script, walk, step, speed, left_first);
  }
}

FigureGait::Footfall FigureGait::standing(const FigureScript& script, int side, double time) const {
  const double heading = script.heading(time);
  const Eigen::Vector2d left(-std::sin(heading), std::cos(heading));
  return {0.0, 0.0, script.place(time) + 0.5 * apart_ * side * left, heading + toe_out * side, 0.0};
}

void FigureGait::step_to(int side, double lift, double land, Footfall place) {
  std::vector<Footfall>& feet = side > 0 ? left_ : right_;
  place.stride = (place.place - feet.back().place).norm();
  // Both at once would be a jump of the figure.
  place.lift = std::max(lift, feet.back().land + 0.02);
  place.land = std::max(land, place.lift + 0.2);
  feet.push_back(place);
}

void FigureGait::step_through(const FigureScript& script, const FigureScript::Interval& walk,
                              double step, double speed, bool left_first) {
  StepCount count = count_steps(script, walk, step, speed);
  const int steps = std::max(static_cast<int>(std::lround(count.steps.back() + 1.0 - ahead)), 2);
  // The last but one foot lands where it stays, the last one beside it.
  const double whole = steps - 1.0 + ahead;
  const double factor = whole / count.steps.back();
  for (double& s : count.steps) s *= factor;
  const double turn = script.heading(count.time_of(1.5)) - script.heading(walk.from);
  int side = std::abs(turn) > 0.3 ? (turn > 0.0 ? 1 : -1) : (left_first ? 1 : -1);
  for (int k = 1; k <= steps; ++k, side = -side) {
    const double lift = count.time_of(k - in_the_air);
    const double land = k < steps ? count.time_of(k) : std::max(walk.to, lift + 0.45);
    step_to(side, lift, land, standing(script, side, count.time_of(std::min(k + ahead, whole))));
  }
}

FootPose FigureGait::foot(int side, double time) const {
  const std::vector<Footfall>& feet = side > 0 ? left_ : right_;
  const auto later = std::upper_bound(feet.begin(), feet.end(), time,
                                      [](double t, const Footfall& f) { return t < f.lift; });
  const auto now = later - 1;
  FootPose pose{now->place, now->heading, 0.0, 0.0};
  const double share = std::min(now->stride / normal_stride, 1.2);
  if (now != feet.begin()) {
    const Footfall& before = *(now - 1);
    const double duration = now->land - now->lift;
    const double t = std::clamp((time - now->lift) / duration, 0.0, 1.0);
    const double done = smooth_step(t, 0.0, 1.0);
    pose.place = before.place + done * (now->place - before.place);
    pose.heading = before.heading + done * (now->heading - before.heading);
    pose.lift = 16.0 * t * t * (1.0 - t) * (1.0 - t) * (0.03 + 0.02 * share);
    pose.pitch += heel_up * share * smooth_step(t, 0.6, 0.0);
    const double planted = later == feet.end() ? 1.0 : later->lift - now->land;
    pose.pitch -= toes_up * share * smooth_step(t, 0.5, 1.0) *
                  smooth_step(time - now->land, std::min(flat_after, planted), 0.0);
  }
  if (later != feet.end()) {
    const double planted = later->lift - now->land;
    const double rise = std::min(0.32, 0.5 * planted);
    const double next = std::min(later->stride / normal_stride, 1.2);
    pose.pitch += heel_up * next * smooth_step(time, later->lift - rise, later->lift);
  }
  return pose;
}

}  // namespace dkp_slam

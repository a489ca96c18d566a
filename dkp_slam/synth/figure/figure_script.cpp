#include "dkp_slam/synth/figure/figure_script.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dkp_slam/synth/figure/figure_loft.h"

namespace dkp_slam {
namespace {

constexpr double turning_speed = 2.4;        // radians per second
constexpr double turns_while_walking = 0.9;  // radians: what needs no halt
constexpr double sitting_down = 1.6;         // seconds
constexpr double getting_up = 1.4;
constexpr double gesture_change = 0.7;
constexpr double pause = 0.25;          // for the foot that closes the last step
constexpr double repeats_for = 3600.0;  // longer than any sequence
constexpr double softness = SmoothTrack<1>::softness;

}  // namespace

template <int size>
auto SmoothTrack<size>::straight(double time) const -> Value {
  if (time <= times_.front()) return values_.front();
  if (time >= times_.back()) return values_.back();
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<std::size_t>(after - times_.begin());
  const double share = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values_[i - 1] + share * (values_[i] - values_[i - 1]);
}

template <int size>
auto SmoothTrack<size>::at(double time) const -> Value {
  // Between knots the integrand is a parabola, for which Simpson's rule is exact.
  const double end = time + softness;
  double from = time - softness;
  auto knot = std::upper_bound(times_.begin(), times_.end(), from);
  if (knot == times_.end()) return values_.back();
  if (*knot >= end && knot == times_.begin()) return values_.front();
  const auto weight = [&](double at) { return (softness - std::abs(at - time)); };
  Value sum = Value::Zero();
  Value value_from = straight(from);
  while (from < end) {
    double to = from < time ? time : end;
    if (knot != times_.end() && *knot <= to) to = *knot++;
    if (to <= from) continue;
    const Value value_to = straight(to);
    const Value middle = 0.5 * (value_from + value_to);
    sum += (to - from) / 6.0 *
           (weight(from) * value_from + 4.0 * weight(0.5 * (from + to)) * middle +
            weight(to) * value_to);
    from = to;
    value_from = value_to;
  }
  return sum / (softness * softness);
}

template class SmoothTrack<1>;
template class SmoothTrack<2>;

FigureScript::FigureScript(const FigureOptions& options) : speed_(options.walking_speed) {
  const Eigen::Vector2d ahead(std::cos(options.heading), std::sin(options.heading));
  sits_ = options.starts_seated;
  const Eigen::Vector2d start = options.start + ((sits_ ? seat_behind : 0.0) * ahead);
  place_.add(0.0, start);
  heading_.add(0.0, SmoothTrack<1>::Value(options.heading));
  constexpr double always = -std::numeric_limits<double>::infinity();
  if (sits_) seated_.push_back({always, true});
  Gesture first = Gesture::none;
  if (!options.activities.empty()) {
    const Activity& activity = options.activities.front();
    if (activity.kind != Activity::Kind::sit || sits_) first = activity.gesture;
  }
  gestures_.push_back({always, first});
  do {
    const double before = time_;
    for (const Activity& activity : options.activities) perform(activity);
    if (time_ == before) break;  // nothing takes any time
  } while (options.repeat && time_ < repeats_for);
  come_to_rest();
}

void FigureScript::perform(const Activity& activity) {
  const double before = time_;
  if (activity.kind != Activity::Kind::sit) {
    change_gesture(before, activity.gesture);
    if (sits_) get_up();
  }
  switch (activity.kind) {
    case Activity::Kind::walk_to:
      walk_to(activity.place);
      return;
    case Activity::Kind::stand:
      come_to_rest();
      turn_to(activity.heading);
      break;
    case Activity::Kind::sit: {
      const Eigen::Vector2d ahead(std::cos(activity.heading), std::sin(activity.heading));
      const Eigen::Vector2d stand = activity.place + seat_behind * ahead;
      const bool there =
          (stand - place_.last()).norm() < 0.03 && std::abs(turn_of(activity.heading)) < 0.05;
      if (!sits_ || !there) {
        change_gesture(time_, Gesture::none);
        if (sits_) get_up();
        walk_to(stand);
        come_to_rest();
        turn_to(activity.heading);
        sit_down();
      }
      change_gesture(std::max(time_ - 0.3, before), activity.gesture);
      break;
    }
  }
  hold(activity.seconds);
}

double FigureScript::turn_of(double heading) const {
  return std::remainder(heading - heading_.last()(0), 2.0 * M_PI);
}

void FigureScript::hold(double seconds) { time_ += std::max(seconds, 0.0); }

void FigureScript::come_to_rest() {
  if (!walks_on_) return;
  time_ += softness + pause;
  walks_on_ = false;
}

void FigureScript::moved(double from, double to) {
  from -= softness;
  to += softness;
  if (!walks_.empty() && from < walks_.back().to + 0.3) {
    walks_.back().to = std::max(walks_.back().to, to);
  } else {
    walks_.push_back({from, to});
  }
}

void FigureScript::walk_to(const Eigen::Vector2d& goal) {
  const Eigen::Vector2d way = goal - place_.last();
  if (way.norm() < 0.03) return;
  if (!walks_on_) time_ += softness;
  walks_on_ = true;
  const double turn = turn_of(std::atan2(way.y(), way.x()));
  const double halt = std::max(std::abs(turn) - turns_while_walking, 0.0) / turning_speed;
  const double turning = std::abs(turn) / turning_speed;
  const double walking = way.norm() / speed_;
  heading_.add(time_, heading_.last());
  heading_.add(time_ + turning, heading_.last() + SmoothTrack<1>::Value(turn));
  place_.add(time_, place_.last());
  place_.add(time_ + halt, place_.last());
  place_.add(time_ + halt + walking, goal);
  const double end = time_ + std::max(halt + walking, turning);
  moved(time_, end);
  time_ = end;
}

void FigureScript::turn_to(double heading) {
  const double turn = turn_of(heading);
  if (std::abs(turn) < 1e-3) return;
  time_ += softness;
  const double turning = std::abs(turn) / turning_speed;
  heading_.add(time_, heading_.last());
  heading_.add(time_ + turning, heading_.last() + SmoothTrack<1>::Value(turn));
  moved(time_, time_ + turning);
  time_ += turning + softness + pause;
}

void FigureScript::sit_down() {
  seated_.push_back({time_, true});
  sits_ = true;
  time_ += sitting_down;
}

void FigureScript::get_up() {
  seated_.push_back({time_, false});
  sits_ = false;
  time_ += getting_up;
}

void FigureScript::change_gesture(double time, Gesture gesture) {
  if (gestures_.back().gesture == gesture) return;
  gestures_.push_back({time, gesture});
}

double FigureScript::seated(double time) const {
  const auto later = std::upper_bound(seated_.begin(), seated_.end(), time,
                                      [](double t, const SeatedChange& c) { return t < c.time; });
  if (later == seated_.begin()) return 0.0;
  const SeatedChange& change = *(later - 1);
  const double duration = change.down ? sitting_down : getting_up;
  const double share = smooth_step(time - change.time, 0.0, duration);
  return change.down ? share : 1.0 - share;
}

std::array<double, gesture_count> FigureScript::gestures(double time) const {
  const auto share_of = [&](const GestureChange& change) {
    return smooth_step(time - change.time, 0.0, gesture_change);
  };
  const auto later = std::upper_bound(gestures_.begin(), gestures_.end(), time,
                                      [](double t, const GestureChange& c) { return t < c.time; });
  auto first = later - 1;
  while (first != gestures_.begin() && share_of(*first) < 1.0) --first;
  std::array<double, gesture_count> shares{};
  shares[static_cast<std::size_t>(first->gesture)] = 1.0;
  for (auto change = first + 1; change < later; ++change) {
    const double share = share_of(*change);
    for (double& s : shares) s *= 1.0 - share;
    shares[static_cast<std::size_t>(change->gesture)] += share;
  }
  return shares;
}

}  // namespace dkp_slam

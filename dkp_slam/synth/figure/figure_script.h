#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "dkp_slam/synth/figure/figure_options.h"

namespace dkp_slam {

constexpr std::size_t gesture_count = 7;

/// Values over time, straight between knots and then smoothed by a triangle of `softness` seconds
/// either way: continuous in the second derivative.
template <int size>
class SmoothTrack {
 public:
  using Value = Eigen::Matrix<double, size, 1>;
  static constexpr double softness = 0.35;

  /// Times must not fall.
  void add(double time, const Value& value) {
    times_.push_back(time);
    values_.push_back(value);
  }
  const Value& last() const { return values_.back(); }
  Value at(double time) const;

 private:
  Value straight(double time) const;

  std::vector<double> times_;
  std::vector<Value> values_;
};

/// What a figure's activities come to: where it is at any time, whether it sits, what its hands do.
class FigureScript {
 public:
  explicit FigureScript(const FigureOptions& options);

  /// Where it stands, and its heading (radians, without jumps). While it sits: where it got up.
  Eigen::Vector2d place(double time) const { return place_.at(time); }
  double heading(double time) const { return heading_.at(time)(0); }
  /// 0 upright, 1 on the seat.
  double seated(double time) const;
  /// Shares of the gestures, in the order of `Gesture`; they sum to 1.
  std::array<double, gesture_count> gestures(double time) const;

  struct Interval {
    double from, to;
  };
  /// When the feet have to go, in order, apart.
  const std::vector<Interval>& walks() const { return walks_; }

  /// The middle of a seat lies this far behind where one stands in front of it, metres.
  static constexpr double seat_behind = 0.30;

 private:
  struct SeatedChange {
    double time;
    bool down;
  };
  struct GestureChange {
    double time;
    Gesture gesture;
  };

  void perform(const Activity& activity);
  void walk_to(const Eigen::Vector2d& goal);
  void turn_to(double heading);
  void sit_down();
  void get_up();
  void come_to_rest();
  void moved(double from, double to);
  void change_gesture(double time, Gesture gesture);
  void hold(double seconds);
  double turn_of(double heading) const;

  double speed_;
  double time_ = 0.0;
  bool sits_ = false, walks_on_ = false;
  SmoothTrack<2> place_;
  SmoothTrack<1> heading_;
  std::vector<SeatedChange> seated_;
  std::vector<GestureChange> gestures_;
  std::vector<Interval> walks_;
};

}  // namespace dkp_slam

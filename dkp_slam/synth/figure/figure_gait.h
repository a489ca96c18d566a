#pragma once

#include <vector>

#include "dkp_slam/synth/figure/figure_script.h"

namespace dkp_slam {

/// A foot at a moment, all continuous in their first derivative.
struct FootPose {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< below the ankle if the sole lay flat
  double heading = 0.0;
  double lift = 0.0;   ///< of the whole foot off the floor, metres
  double pitch = 0.0;  ///< heel up: positive, toes up: negative, radians
};

/// Where a figure steps. A foot that is on the floor stays where it is; what rolls is in `pitch`.
class FigureGait {
 public:
  /// `step`: metres from foot to foot at `speed`, metres per second; `apart`: between the feet.
  FigureGait(const FigureScript& script, double step, double speed, double apart, bool left_first);

  /// side: 1 left, -1 right.
  FootPose foot(int side, double time) const;

 private:
  /// The foot leaves the floor at `lift` and stays at `place` from `land` on.
  struct Footfall {
    double lift, land;
    Eigen::Vector2d place;
    double heading;
    double stride;  ///< metres from the place before
  };

  Footfall standing(const FigureScript& script, int side, double time) const;
  void step_through(const FigureScript& script, const FigureScript::Interval& walk, double step,
                    double speed, bool left_first);
  void step_to(int side, double lift, double land, Footfall place);

  double apart_;
  std::vector<Footfall> left_, right_;
};

}  // namespace dkp_slam

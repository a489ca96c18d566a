#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/synthetic/shapes.h"

namespace dkp_slam {

/// A closed walk around a point on the floor, metres and radians.
struct WalkingLoop {
  Eigen::Vector2d centre = {0.0, 1.35};
  Eigen::Vector2d radii = {1.75, 1.05};
  double start = 0.0;  ///< angle at time 0
  double speed = 0.9;  ///< metres per second
};

/// A figure of ellipsoids and capsules that walks a loop. World frame: z up, the floor at 0.
class Person {
 public:
  /// Height, clothes and gait come from `rng`.
  Person(cv::RNG& rng, const WalkingLoop& loop);

  /// The body's parts at a time, seconds.
  std::vector<Solid> at(double time) const;

 private:
  struct Frame;

  void add_leg(const Frame& frame, double side, double phase, std::vector<Solid>* parts) const;
  void add_arm(const Frame& frame, double side, double phase, std::vector<Solid>* parts) const;
  void add_trunk(const Frame& frame, std::vector<Solid>* parts) const;

  WalkingLoop loop_;
  double scale_;  ///< of the body; 1: 1.75 m tall
  TexturePtr shirt_, trousers_, shoes_, skin_, head_, sleeves_;
};

}  // namespace dkp_slam

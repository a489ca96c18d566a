#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dkp_slam {

/// What the hands do meanwhile.
enum class Gesture { none, talk, wave, point, phone, type, carry };

/// One thing that a figure does, after the one before it. How it gets there (turning, sitting down,
/// getting up) it knows itself, and takes the time that people take.
struct Activity {
  enum class Kind {
    walk_to,  ///< in a straight line to `place`
    stand,    ///< where it is, looking along `heading`
    sit,      ///< on a seat at `place` (its middle, 0.45 m high), looking along `heading`
  };
  Kind kind = Kind::stand;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< metres; of walk_to and sit
  double heading = 0.0;                             ///< radians from +x to +y; of stand and sit
  double seconds = 0.0;                             ///< how long; walk_to: as its speed gives
  Gesture gesture = Gesture::none;
};

struct FigureOptions {
  std::uint64_t seed = 1;  ///< body, face, hair, clothes, gait
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  double heading = 0.0;              ///< at the start, radians from +x to +y
  bool starts_seated = false;        ///< on a seat at `start`
  double walking_speed = 1.1;        ///< metres per second
  std::vector<Activity> activities;  ///< the last one goes on for ever, or with `repeat`: again
  bool repeat = false;               ///< from the first one, when the last is done; for an hour
};

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/synth/figure/figure_options.h"

namespace dkp_slam {

/// Everything a figure can do, about a minute long.
inline FigureOptions busy_day(std::uint64_t seed) {
  FigureOptions options;
  options.seed = seed;
  options.start = {-1.0, -1.0};
  options.heading = 2.5;
  options.activities = {{Activity::Kind::walk_to, {1.5, 0.0}, 0.0, 0.0, Gesture::none},
                        {Activity::Kind::walk_to, {1.5, 1.5}, 0.0, 0.0, Gesture::carry},
                        {Activity::Kind::walk_to, {-1.0, 1.5}, 0.0, 0.0, Gesture::carry},
                        {Activity::Kind::stand, {0, 0}, 3.0, 3.0, Gesture::wave},
                        {Activity::Kind::sit, {-1.0, 0.0}, -1.5, 4.0, Gesture::type},
                        {Activity::Kind::sit, {-1.0, 0.0}, -1.5, 2.0, Gesture::phone},
                        {Activity::Kind::stand, {0, 0}, 1.0, 2.0, Gesture::talk},
                        {Activity::Kind::walk_to, {0.2, 0.1}, 0.0, 0.0, Gesture::phone},
                        {Activity::Kind::stand, {0, 0}, -2.5, 2.0, Gesture::point},
                        {Activity::Kind::sit, {-1.0, 0.0}, -1.5, 3.0, Gesture::none}};
  return options;
}

inline FigureOptions doing(Gesture gesture) {
  FigureOptions options;
  options.activities = {{Activity::Kind::stand, {0, 0}, 0.0, 10.0, gesture}};
  return options;
}

inline FigureOptions seated(std::uint64_t seed) {
  FigureOptions options;
  options.seed = seed;
  options.start = {1.0, 2.0};
  options.heading = 0.7;
  options.starts_seated = true;
  options.activities = {{Activity::Kind::sit, {1.0, 2.0}, 0.7, 5.0, Gesture::none}};
  return options;
}

inline FigureOptions walking(double metres) {
  FigureOptions options;
  options.activities = {{Activity::Kind::walk_to, {metres, 0.0}, 0.0, 0.0, Gesture::none}};
  return options;
}

}  // namespace dkp_slam

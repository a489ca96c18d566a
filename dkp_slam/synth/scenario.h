#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "dkp_slam/synth/scenario_parts.h"

namespace dkp_slam {

/// Every scenario's name and what happens in it, in the order in which they are to be shown:
/// twins of the six sequences of the TUM benchmark that the paper is measured on (walking_xyz,
/// walking_rpy, walking_halfsphere, walking_static, sitting_static, sitting_xyz), and what those
/// leave out (crowd, close_up, moved_furniture, static_room, flat_loop, lights, dropped_frames).
struct ScenarioName {
  std::string name, description;
};
const std::vector<ScenarioName>& scenario_names();

/// Throws `Error` on a name that is none of `scenario_names`. Same name and seed, same scenario:
/// the seed changes colours, prints, people's looks and pace, and the camera's path.
Scenario make_scenario(const std::string& name, std::uint64_t seed);

/// Frames that a sequence of this scenario should have, 30 a second: 600; of moved_furniture 1110;
/// of flat_loop as many as bring the camera around the flat and three seconds on.
std::size_t default_frames(const std::string& name);

/// Numbers of the `count` frames that arrive when some are lost on the way: now and then a single
/// one, and every few seconds a burst of 0.3 to 1 second. The first second's are all there.
std::vector<std::size_t> arriving_frames(std::size_t count, double rate, std::uint64_t seed);

}  // namespace dkp_slam

#pragma once

#include <cstdint>

#include "dkp_slam/synth/scenario_parts.h"

namespace dkp_slam {

/// What happens in the office and in the flat: each adds people and things that move, their chairs,
/// and what the lamps do. The scripts go on for ever; nobody walks through furniture, another one,
/// or the camera on its built-in motions.

/// Two people sit at the desk, get up, walk before it and behind it, one carries a box, and sit
/// down again: after freiburg3's walking sequences.
void two_walk(std::uint64_t seed, Scenario& scenario);
/// Two people sit at the desk, talk, point and telephone: after freiburg3's sitting sequences.
void two_sit(std::uint64_t seed, Scenario& scenario);
/// Five people: two of them sit at times.
void crowd(std::uint64_t seed, Scenario& scenario);
/// Somebody walks right past the camera, comes back, and stands before it for four seconds.
void close_up(std::uint64_t seed, Scenario& scenario);
/// Somebody stands right before the camera, which already turns when the recording begins, fills
/// more than half of the view, and walks off after some seconds. Sets the camera's motion back.
void covered_start(std::uint64_t seed, Scenario& scenario);
/// Somebody pushes a chair, opens a drawer and carries a box away; a robot drives about and the
/// drawer closes when nobody is in view.
void moved_furniture(std::uint64_t seed, Scenario& scenario);
/// Two people walk; the lamps are off for a second and a half in every six.
void lights(std::uint64_t seed, Scenario& scenario);
/// Somebody walks to and fro in a room of the flat.
void somebody_in_the_flat(std::uint64_t seed, Scenario& scenario);

}  // namespace dkp_slam

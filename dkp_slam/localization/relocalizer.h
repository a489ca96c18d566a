#pragma once

#include <cstdint>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// Finds the pose of a frame in the map without a guess: keyframes that look like it from the
/// index, matches by descriptor, 3-D to 3-D RANSAC, refinement, and a guided search for more. On
/// success sets the frame's pose, landmarks and reference keyframe and returns true; else its pose
/// means nothing and it has no landmarks. Repeats exactly for the same seed.
bool relocalize(const Map& map, const PlaceIndex& places, const MeasurementModel& model,
                std::uint64_t seed, Frame& frame);

/// The same from one keyframe and those around it. Returns how many landmarks the frame then has;
/// 0 when its pose was not found.
int localize_by_keyframe(const Map& map, const MeasurementModel& model, std::uint64_t seed,
                         int keyframe, Frame& frame);

}  // namespace dkp_slam

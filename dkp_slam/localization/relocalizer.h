#pragma once

#include <cstdint>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/matcher.h"
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

/// The first half of it, with one keyframe: sets the frame's pose by the landmarks that the
/// keyframe has, and returns the matches that agree on it; none when there is no such pose. Asks
/// nothing of the map beyond that keyframe and those landmarks (see excerpt_of).
std::vector<FrameMatch> align_to_keyframe(const Map& map, const MeasurementModel& model,
                                          std::uint64_t seed, int keyframe, Frame& frame);

/// The second half: searches for more landmarks of the keyframe and those around it where the
/// frame's pose says they are, and refines the pose. Returns how many landmarks the frame then has;
/// 0 when they are too few, or nearly all of them new in a map that is not.
int localize_around(const Map& map, const MeasurementModel& model, int keyframe,
                    std::vector<FrameMatch> matches, Frame& frame);

/// Both halves.
int localize_by_keyframe(const Map& map, const MeasurementModel& model, std::uint64_t seed,
                         int keyframe, Frame& frame);

/// What is believed where the two do not agree.
enum class Trust {
  masks,  ///< dynamic features have no say
  map,    ///< features that agree with many landmarks on one pose are static, whatever hid them
};

/// The same where the frame's pose is a guess, off by some degrees or a tenth of the distance: a
/// wide search for the landmarks of the keyframe and those around it, then as above. Finds a view
/// of which the index knows too little, as what is left beside people.
int localize_near(const Map& map, const MeasurementModel& model, std::uint64_t seed, int keyframe,
                  Trust trust, Frame& frame);

}  // namespace dkp_slam

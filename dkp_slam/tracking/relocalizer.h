#pragma once

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/tracking/frame.h"

namespace dkp_slam {

/// Finds the pose of a frame in the map without a guess: descriptors against every keyframe in
/// turn, newest first, PnP with RANSAC on the best, refinement, and a guided search for more. On
/// success sets the frame's pose, landmarks and reference keyframe and returns true.
bool relocalize(const Map& map, const MeasurementModel& model, Frame& frame);

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// Looks for a keyframe's landmarks in its neighbours and for theirs in it: a feature without a
/// landmark gets the sighting, two landmarks in one place become one (Mur-Artal et al. 2015,
/// §VI-C).
void fuse_with_neighbours(Map& map, const MeasurementModel& model, int keyframe);

}  // namespace dkp_slam

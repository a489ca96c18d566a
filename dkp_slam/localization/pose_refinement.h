#pragma once

#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {

/// What a feature measures, with its level's noise.
Observation observation_of(const FrameFeatures& features, int feature, const Map& map,
                           const MeasurementModel& model);

/// What the frame sees of the landmarks that it is matched with, match by match.
std::vector<PoseObservation> observations_of(const Frame& frame,
                                             const std::vector<FrameMatch>& matches, const Map& map,
                                             const MeasurementModel& model);

/// Optimises the frame's pose over the matches, moves it there, and erases the outliers from
/// `matches`. Returns the number of inliers.
int refine_pose(const Map& map, const MeasurementModel& model, Frame& frame,
                std::vector<FrameMatch>& matches);

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// A keyframe as a frame that knows nothing of the map, to be localised in it anew.
Frame frame_of(const Keyframe& keyframe);

/// Joins the map that a keyframe belongs to with the one that `old` belongs to, which `seen`, the
/// keyframe localised by `old`, has shown to be the same place: the younger of the two maps moves.
void join_map_of(Map& map, int keyframe, int old, const Frame& seen);

/// Makes one of the landmarks that a keyframe has and those that it was found to show (`seen`), and
/// looks for more of that kind about its `neighbours` best neighbours. Both must lie in one map.
void fuse_seen_again(Map& map, const MeasurementModel& model, int keyframe, const Frame& seen,
                     int neighbours);

}  // namespace dkp_slam

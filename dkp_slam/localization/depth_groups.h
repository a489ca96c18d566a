#pragma once

#include <cstddef>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {

/// What a view shows of the map, parted by how far away it is.
struct DepthGroups {
  std::vector<std::size_t> near, far;  ///< indices, from the nearest to the farthest
};

/// The split of nearness (1 over depth) that leaves least variance within either group (Otsu's),
/// neither of them of fewer than `least`. All are near where there are fewer than twice as many.
DepthGroups split_by_depth(const Se3& camera_from_world,
                           const std::vector<PoseObservation>& observations, std::size_t least);

/// Those of one of its groups.
std::vector<PoseObservation> some_of(const std::vector<PoseObservation>& all,
                                     const std::vector<std::size_t>& indices);

/// Of a frame whose pose is about right: its matches that lie on the room, where near and far ones
/// put the camera elsewhere. That is where somebody has stood so close since the map was begun that
/// he is most of it, and now walks away. What is seen of a body so close extends less far than a
/// desk, and a third as far as the rest of a room: where one of the groups does, the other is the
/// room. Empty where they agree, or it cannot be told.
std::vector<FrameMatch> matches_on_room(const Map& map, const MeasurementModel& model,
                                        const Frame& frame, const std::vector<FrameMatch>& matches);

}  // namespace dkp_slam

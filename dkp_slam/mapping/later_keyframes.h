#pragma once

#include "dkp_slam/map/map.h"

namespace dkp_slam {

/// Moves a map that has grown since the snapshot that the move was found by: keyframes from the id
/// `first_later` on keep their place relative to their nearest ancestor among those of the move
/// (Mur-Artal and Tardos 2017, "ORB-SLAM2", section III-C). Those of the move may have been removed
/// since.
void move_with_later_keyframes(Map& map, MapMove move, int first_later);

}  // namespace dkp_slam

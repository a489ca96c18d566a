#pragma once

#include <vector>

#include "dkp_slam/loop/map_joiner.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/map/map_parts.h"

namespace dkp_slam {

/// Two maps in one.
struct MergedMap {
  Map map;
  /// Those of its maps that were found to show the same place; the others lie side by side, each in
  /// its own world frame.
  std::vector<JoinedMaps> joined;
};

/// Both maps as one, ids of `b` counted on from those of `a` (see merged); maps that show the same
/// place are joined and adjusted. Cameras and pyramids must be alike (see difference_of). Same
/// maps, same result.
MergedMap merge_maps(MapParts a, MapParts b);

}  // namespace dkp_slam

#pragma once

#include <vector>

#include "dkp_slam/map/map.h"
#include "dkp_slam/map/map_parts.h"

namespace dkp_slam {

/// The parts of a map; `Map(parts_of(map))` is the same map with everything that was computed
/// computed anew.
MapParts parts_of(const Map& map);

/// One keyframe and the landmarks that it sees, as a small map of its own.
struct Excerpt {
  MapParts parts;              ///< the keyframe has id 0, the landmarks are counted from 0
  std::vector<int> landmarks;  ///< their ids in the map that this was taken from, ascending
};
Excerpt excerpt_of(const Map& map, int keyframe);

/// Per keyframe id: the keyframe itself, or its nearest ancestor in the map where it has been
/// removed; -1 for none.
std::vector<int> live_ancestors(const Map& map);

}  // namespace dkp_slam

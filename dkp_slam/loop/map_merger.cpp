#include "dkp_slam/loop/map_merger.h"

#include <utility>

#include "dkp_slam/mapping/full_adjustment.h"

namespace dkp_slam {
namespace {

/// Joins those of the maps that show the same place.
std::vector<JoinedMaps> join_what_meets(Map& map) {
  const MeasurementModel model;
  constexpr int iterations = 20;
  PlaceIndex places;
  for (int which = 0; which < map.maps(); ++which) {
    for (const int k : map.keyframes_in(which)) places.add_keyframe(map, k);
  }
  std::vector<JoinedMaps> joined = join_maps(map, places, model);
  for (const JoinedMaps& j : joined) adjust_map(map, model, j.kept, iterations);
  return joined;
}

}  // namespace

MergedMap merge_maps(MapParts a, MapParts b) {
  MergedMap both{Map(merged(std::move(a), std::move(b))), {}};
  both.joined = join_what_meets(both.map);
  return both;
}

}  // namespace dkp_slam

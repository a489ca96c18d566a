#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

struct MapJoinerOptions {
  std::size_t candidates = 5;  ///< keyframes of other maps that are tried for each
  int least_votes = 15;
  int least_matches = 40;  ///< landmarks of the other map that a keyframe must show
  /// Keyframes that must tell the same of how the two maps lie to one another, within the bounds
  /// below: two places that look alike do not, from several sides.
  int agreeing = 3;
  double translation_bound = 0.15;  ///< metres, where the keyframe stands
  double rotation_bound = 0.10;     ///< radians
  int fused_neighbours = 8;
};

/// Two maps that were joined.
struct JoinedMaps {
  int kept = -1, moved = -1;  ///< numbers of the maps; all is in `kept` now
  int keyframes = 0;          ///< that agreed on how they lie to one another
};

/// Looks for places that two of the maps show, and joins those maps: all keyframes of one are asked
/// for in the others. For maps that were made apart; of maps made in one run the loop closer joins
/// those that meet. Same seed, same result. Bundle adjustment is left to the caller.
std::vector<JoinedMaps> join_maps(Map& map, const PlaceIndex& places, const MeasurementModel& model,
                                  const MapJoinerOptions& options = {}, std::uint64_t seed = 1);

}  // namespace dkp_slam

#include "dkp_slam/mapping/later_keyframes.h"

#include <cstddef>
#include <span>

#include "dkp_slam/map/find_id.h"

namespace dkp_slam {

void move_with_later_keyframes(Map& map, MapMove move, int first_later) {
  const std::size_t known = move.keyframes.size();
  const auto find = [&](int id) {
    return find_id(std::span<const MapMove::Keyframe>(move.keyframes).first(known), id);
  };
  for (int k = first_later; k < map.keyframe_ids(); ++k) {
    if (map.keyframe(k).removed) continue;
    int ancestor = map.keyframe(k).parent;
    while (ancestor >= 0 && !find(ancestor)) ancestor = map.keyframe(ancestor).parent;
    if (ancestor < 0) continue;
    move.keyframes.push_back({k, find(ancestor)->world_after_from_before, {}});
  }
  map.move(std::move(move));
}

}  // namespace dkp_slam

#include "dkp_slam/loop/loop_detector.h"

#include <algorithm>

namespace dkp_slam {
namespace {

/// A keyframe and all that share enough landmarks with it.
std::vector<int> around(const Map& map, int keyframe) {
  std::vector<int> ids = map.best_covisible(keyframe, map.keyframe_ids());
  ids.push_back(keyframe);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// The keyframe, its neighbours and theirs: local bundle adjustment holds them together already.
std::vector<char> tied(const Map& map, int keyframe) {
  std::vector<char> flags(static_cast<std::size_t>(map.keyframe_ids()), 0);
  for (const int near : around(map, keyframe)) {
    for (const int k : around(map, near)) flags[static_cast<std::size_t>(k)] = 1;
  }
  return flags;
}

bool overlap(const std::vector<int>& a, const std::vector<int>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int k) { return std::binary_search(b.begin(), b.end(), k); });
}

}  // namespace

std::vector<int> LoopDetector::detect(const Map& map, const PlaceIndex& places, int keyframe) {
  std::vector<PlaceCandidate> votes = places.votes(map, map.keyframe(keyframe).features.descriptor);
  const std::vector<char> known = tied(map, keyframe);
  std::erase_if(votes, [&](const PlaceCandidate& c) {
    return known[static_cast<std::size_t>(c.keyframe)] || c.votes < options_.least_votes;
  });
  std::vector<Group> groups;
  std::vector<int> closing;
  for (const PlaceCandidate& c : places.best_groups(map, votes, options_.candidates)) {
    Group group{around(map, c.keyframe), 1};
    for (const Group& before : groups_) {
      if (overlap(group.keyframes, before.keyframes))
        group.seen = std::max(group.seen, before.seen + 1);
    }
    if (group.seen >= options_.consistent) closing.push_back(c.keyframe);
    groups.push_back(std::move(group));
  }
  groups_ = std::move(groups);
  return closing;
}

}  // namespace dkp_slam

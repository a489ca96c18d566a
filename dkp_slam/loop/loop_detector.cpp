#include "dkp_slam/loop/loop_detector.h"

#include <algorithm>

#include "dkp_slam/map/id_map.h"

namespace dkp_slam {
namespace {

/// A keyframe and all that share enough landmarks with it.
std::vector<int> around(const Map& map, int keyframe) {
  std::vector<int> ids = {keyframe};
  for (const auto& [id, shared] : map.keyframe(keyframe).covisible) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// The keyframe, its neighbours and theirs: local bundle adjustment holds them together already.
IdSet tied(const Map& map, int keyframe) {
  IdSet ids;
  for (const int near : around(map, keyframe)) {
    ids.insert(near);
    for (const auto& [id, shared] : map.keyframe(near).covisible) ids.insert(id);
  }
  return ids;
}

bool overlap(const std::vector<int>& a, const std::vector<int>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int k) { return std::binary_search(b.begin(), b.end(), k); });
}

}  // namespace

void LoopDetector::look_at(int keyframe) {
  keyframe_ = keyframe;
  next_feature_ = 0;
  votes_.clear();
}

std::optional<std::vector<int>> LoopDetector::advance(const Map& map, const PlaceIndex& places) {
  const std::span<const Descriptor> all(map.keyframe(keyframe_).features.descriptor);
  if (next_feature_ < all.size()) {
    const std::size_t count = std::min(options_.features_per_frame, all.size() - next_feature_);
    count_votes(map, places, all.subspan(next_feature_, count));
    next_feature_ += count;
    return std::nullopt;
  }
  // A keyframe that has been removed meanwhile shows nothing any more.
  std::vector<int> closing;
  if (!map.keyframe(keyframe_).removed) closing = closing_keyframes(map, places);
  keyframe_ = -1;
  return closing;
}

void LoopDetector::count_votes(const Map& map, const PlaceIndex& places,
                               std::span<const Descriptor> features) {
  std::vector<PlaceCandidate> sum;
  auto before = votes_.cbegin();
  for (PlaceCandidate c : places.votes(map, features)) {
    while (before != votes_.cend() && before->keyframe < c.keyframe) sum.push_back(*before++);
    if (before != votes_.cend() && before->keyframe == c.keyframe) {
      c.votes += before->votes;
      c.score += before->score;
      ++before;
    }
    sum.push_back(c);
  }
  sum.insert(sum.end(), before, votes_.cend());
  votes_ = std::move(sum);
}

std::vector<int> LoopDetector::closing_keyframes(const Map& map, const PlaceIndex& places) {
  const IdSet known = tied(map, keyframe_);
  std::erase_if(votes_, [&](const PlaceCandidate& c) {
    const bool later = c.keyframe > keyframe_;  // came while this one waited for its turn
    return later || known.contains(c.keyframe) || c.votes < options_.least_votes ||
           map.keyframe(c.keyframe).removed;
  });
  std::vector<Group> groups;
  std::vector<int> closing;
  for (const PlaceCandidate& c : places.best_groups(map, votes_, options_.candidates)) {
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

#include "dkp_slam/localization/place_index.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "dkp_slam/cpu.h"
#include "dkp_slam/map/id_map.h"

namespace dkp_slam {
namespace {

constexpr std::size_t lanes = 16;  // of 16 bits, in a descriptor
constexpr std::size_t keys = std::size_t{1} << 16;

std::uint32_t lane(const Descriptor& d, std::size_t i) {
  i %= lanes;
  return static_cast<std::uint32_t>(d[i / 4] >> (16 * (i % 4))) & 0xFFFFU;
}

/// Entries of the slots whose signature is near enough.
DKP_SLAM_POPCNT void popcnt_filter(std::span<const PlaceBucket::Slot> slots,
                                   std::uint32_t signature, int bound,
                                   std::vector<std::int32_t>& out) {
  for (const auto& s : slots) {
    if (__builtin_popcount(s.signature ^ signature) <= bound) out.push_back(s.entry);
  }
}

void portable_filter(std::span<const PlaceBucket::Slot> slots, std::uint32_t signature, int bound,
                     std::vector<std::int32_t>& out) {
  for (const auto& s : slots) {
    if (__builtin_popcount(s.signature ^ signature) <= bound) out.push_back(s.entry);
  }
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

PlaceIndex::PlaceIndex(const PlaceIndexOptions& options)
    : options_(options), lanes_apart_(lanes / static_cast<std::size_t>(options.tables)) {
  assert(options.tables >= 1 && options.tables <= static_cast<int>(lanes));
  buckets_.resize(static_cast<std::size_t>(options.tables) * keys);
}

const PlaceBucket& PlaceIndex::bucket(std::size_t table, const Descriptor& d) const {
  return buckets_[table * keys + lane(d, table * lanes_apart_)];
}

PlaceBucket& PlaceIndex::bucket(std::size_t table, const Descriptor& d) {
  return buckets_[table * keys + lane(d, table * lanes_apart_)];
}

std::uint32_t PlaceIndex::signature(std::size_t table, const Descriptor& d) const {
  return lane(d, table * lanes_apart_ + 1) << 16 | lane(d, table * lanes_apart_ + 2);
}

bool PlaceIndex::wants(int landmark, const Descriptor& look) const {
  const std::int32_t* first = first_entry_.find(landmark);
  int looks = 0;
  for (std::int32_t e = first ? *first : none; e != none; ++looks) {
    const Entry& entry = entries_[static_cast<std::size_t>(e)];
    if (hamming_distance(entry.descriptor, look) < options_.another_look_bits) return false;
    e = entry.next;
  }
  return looks < options_.most_looks;
}

void PlaceIndex::insert(int landmark, const Descriptor& look) {
  const std::int32_t* first = first_entry_.find(landmark);
  if (free_.empty()) {
    free_.push_back(static_cast<std::int32_t>(entries_.size()));
    entries_.emplace_back();
  }
  const std::int32_t e = free_.back();
  free_.pop_back();
  entries_[static_cast<std::size_t>(e)] = {look, landmark, first ? *first : none};
  first_entry_.set(landmark, e);
  for (std::size_t t = 0; t < static_cast<std::size_t>(options_.tables); ++t) {
    bucket(t, look).insert({signature(t, look), e});
  }
}

void PlaceIndex::erase(std::int32_t e) {
  Entry& entry = entries_[static_cast<std::size_t>(e)];
  for (std::size_t t = 0; t < static_cast<std::size_t>(options_.tables); ++t) {
    bucket(t, entry.descriptor).erase(e);
  }
  entry.landmark = none;
  free_.push_back(e);
}

void PlaceIndex::tidy(const Map& map) {
  const std::size_t count = std::min(options_.tidied_per_keyframe, entries_.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (next_to_tidy_ >= entries_.size()) {
      next_to_tidy_ = 0;
      followed_ = at_tidy_start_;
      at_tidy_start_ = map.fusions();
    }
    const std::int32_t landmark = entries_[next_to_tidy_++].landmark;
    if (landmark == none || map.has_landmark(landmark)) continue;
    // What it was fused into looks like it too.
    const int heir = map.resolve(landmark);
    std::int32_t e = first_entry_[landmark];
    first_entry_.erase(landmark);
    while (e != none) {
      const Entry gone = entries_[static_cast<std::size_t>(e)];
      erase(e);
      if (heir >= 0 && wants(heir, gone.descriptor)) insert(heir, gone.descriptor);
      e = gone.next;
    }
  }
}

void PlaceIndex::add_keyframe(const Map& map, int keyframe) {
  tidy(map);
  const Keyframe& k = map.keyframe(keyframe);
  int left = options_.most_new;
  for (const bool seen_before : {true, false}) {
    for (std::size_t f = 0; f < k.landmarks.size() && left > 0; ++f) {
      if (k.landmarks[f] < 0) continue;
      if ((map.landmark(k.landmarks[f]).sightings.size() > 1) != seen_before) continue;
      if (!wants(k.landmarks[f], k.features.descriptor[f])) continue;
      insert(k.landmarks[f], k.features.descriptor[f]);
      --left;
    }
  }
}

void PlaceIndex::find(const Map& map, const Descriptor& feature, std::vector<std::int32_t>& near,
                      std::vector<int>& landmarks) const {
  near.clear();
  landmarks.clear();
  for (std::size_t t = 0; t < static_cast<std::size_t>(options_.tables); ++t) {
    const auto slots = bucket(t, feature).slots();
    if (slots.size() > options_.busy_bucket) continue;
    const auto filter = have_popcnt() ? popcnt_filter : portable_filter;
    filter(slots, signature(t, feature), options_.signature_bits, near);
  }
  sort_unique(near);
  for (const std::int32_t e : near) {
    const Entry& entry = entries_[static_cast<std::size_t>(e)];
    if (hamming_distance(entry.descriptor, feature) > options_.match_bits) continue;
    const int landmark = map.resolve(entry.landmark);
    if (landmark >= 0) landmarks.push_back(landmark);
  }
  sort_unique(landmarks);
}

std::vector<PlaceCandidate> PlaceIndex::votes(const Map& map,
                                              std::span<const Descriptor> frame) const {
  struct Ballot {
    std::size_t candidate;   // index into all
    std::size_t last_voter;  // a feature has one vote
  };
  std::vector<PlaceCandidate> all;
  IdMap<Ballot> ballots;
  std::vector<std::int32_t> near;
  std::vector<int> landmarks;
  std::vector<std::size_t> voted_for;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    find(map, frame[i], near, landmarks);
    voted_for.clear();
    for (const int l : landmarks) {
      for (const Sighting& s : map.landmark(l).sightings) {
        const auto [ballot, first_vote] = ballots.insert(s.keyframe, {all.size(), i});
        if (first_vote) {
          all.push_back({s.keyframe});
        } else if (ballot.last_voter == i) {
          continue;
        }
        ballot.last_voter = i;
        voted_for.push_back(ballot.candidate);
      }
    }
    if (voted_for.empty()) continue;
    const double weight = std::log(1.0 + map.live_keyframes() / double(voted_for.size()));
    for (const std::size_t c : voted_for) {
      ++all[c].votes;
      all[c].score += weight;
    }
  }
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; });
  return all;
}

std::vector<PlaceCandidate> PlaceIndex::query(const Map& map, std::span<const Descriptor> frame,
                                              std::size_t most) const {
  return best_groups(map, votes(map, frame), most);
}

std::vector<PlaceCandidate> PlaceIndex::best_groups(const Map& map,
                                                    const std::vector<PlaceCandidate>& all,
                                                    std::size_t most) const {
  int most_votes = 0;
  IdMap<std::size_t> of_keyframe;  // index into all
  for (std::size_t i = 0; i < all.size(); ++i) {
    most_votes = std::max(most_votes, all[i].votes);
    of_keyframe.insert(all[i].keyframe, i);
  }
  const double bound =
      std::max(double(options_.least_votes), options_.least_vote_share * most_votes);
  std::vector<PlaceCandidate> groups;
  for (const PlaceCandidate& c : all) {
    if (c.votes < bound) continue;
    PlaceCandidate best = c;
    double sum = c.score;
    for (const int n : map.best_covisible(c.keyframe, options_.group)) {
      const std::size_t* i = of_keyframe.find(n);
      if (!i) continue;
      const PlaceCandidate& neighbour = all[*i];
      sum += neighbour.score;
      const bool tie = neighbour.score == best.score && neighbour.keyframe < best.keyframe;
      if (neighbour.score > best.score || tie) best = neighbour;
    }
    best.group_score = sum;
    groups.push_back(best);
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.group_score > b.group_score; });
  std::vector<PlaceCandidate> candidates;
  for (const PlaceCandidate& g : groups) {
    if (candidates.size() == most ||
        g.group_score < options_.least_group_share * groups.front().group_score)
      break;
    const bool known =
        std::any_of(candidates.begin(), candidates.end(),
                    [&](const PlaceCandidate& c) { return c.keyframe == g.keyframe; });
    if (!known) candidates.push_back(g);
  }
  return candidates;
}

std::size_t PlaceIndex::memory() const {
  std::size_t bytes = buckets_.capacity() * sizeof(PlaceBucket) +
                      entries_.capacity() * sizeof(Entry) +
                      free_.capacity() * sizeof(std::int32_t) + first_entry_.memory();
  for (const PlaceBucket& b : buckets_) bytes += b.memory();
  return bytes;
}

}  // namespace dkp_slam

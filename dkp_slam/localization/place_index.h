#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dkp_slam/feature/descriptor.h"
#include "dkp_slam/localization/place_bucket.h"
#include "dkp_slam/map/id_table.h"
#include "dkp_slam/map/map.h"

namespace dkp_slam {

class OptionList;

struct PlaceIndexOptions {
  /// Hash tables, at most 16; each takes another 16 of the 256 bits as its key. A descriptor with
  /// one bit in eight wrong shares a key with its landmark in 8 tables two times out of three;
  /// votes need no more, and 16 tables cost twice the time and memory.
  int tables = 8;
  /// Bits by which a feature may differ from a landmark it votes for; the matcher's strict bound.
  int match_bits = 50;
  /// Of 32 further bits, which are compared first because they lie in the table itself.
  int signature_bits = 10;
  /// A landmark gets another descriptor when it looks this many bits different from those it has,
  int another_look_bits = 40;
  int most_looks = 3;  ///< and no more than so many.
  /// Landmarks that one keyframe may add. Those seen before come first: of the new ones most are
  /// culled soon, and what remains is added by the next keyframe that sees it.
  int most_new = 250;
  /// A longer list is passed over in a query: what looks like everything tells no place.
  std::size_t busy_bucket = 256;
  /// Entries looked through at each keyframe for those whose landmark has gone.
  std::size_t tidied_per_keyframe = 2048;
  /// A candidate has at least this share of the best one's votes, before neighbours are added,
  double least_vote_share = 0.3;
  /// and of its score after (Mur-Artal and Tardos 2014, "Fast Relocalisation and Loop Closing in
  /// Keyframe-Based SLAM", section III).
  double least_group_share = 0.75;
  int group = 10;       ///< keyframes that share most with one, whose scores add up
  int least_votes = 8;  ///< fewer features in common are chance

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Keyframe that may show what a frame shows.
struct PlaceCandidate {
  int keyframe = -1;
  int votes = 0;             ///< features of the frame that look like a landmark it sees
  double score = 0.0;        ///< the votes, each weighted by how few keyframes it speaks for
  double group_score = 0.0;  ///< with the scores of the keyframes around it
};

/// Finds the keyframes that show the same place as a frame, by appearance alone and without a
/// vocabulary: a multi-index hash (Norouzi, Punjani and Fleet 2012, "Fast Search in Hamming Space
/// with Multi-Index Hashing") over the descriptors of landmarks.
///
/// Landmarks and not features: a landmark is stored once however many keyframes see it, and votes
/// for all of them. So a culled keyframe loses its votes together with its sightings, and nothing
/// has to be taken out; entries of landmarks that have gone are cleared away little by little.
///
/// Belongs to the thread that owns the map. Deterministic.
class PlaceIndex {
 public:
  explicit PlaceIndex(const PlaceIndexOptions& options = {});

  /// Enters the landmarks of a keyframe; to be called once it has them.
  void add_keyframe(const Map& map, int keyframe);

  /// Per keyframe that any of the descriptors votes for, in the order of their ids; without groups.
  std::vector<PlaceCandidate> votes(const Map& map, std::span<const Descriptor> frame) const;

  /// The best keyframes of the best groups among keyframes with votes, best group first.
  std::vector<PlaceCandidate> best_groups(const Map& map, const std::vector<PlaceCandidate>& all,
                                          std::size_t most) const;

  /// Both in one: at most `most` keyframes that may show what the frame shows, best first.
  std::vector<PlaceCandidate> query(const Map& map, std::span<const Descriptor> frame,
                                    std::size_t most) const;

  /// How many of the map's fusions (see Map::fusions) the index has followed everywhere: it holds
  /// no landmark any more that was fused by one of the first so many.
  std::int64_t followed_fusions() const { return followed_; }

  /// Descriptors stored.
  std::size_t size() const { return entries_.size() - free_.size(); }
  /// What the index holds on the heap, bytes.
  std::size_t memory() const;

 private:
  static constexpr std::int32_t none = -1;
  struct Entry {
    Descriptor descriptor;
    std::int32_t landmark = none;  // none: the entry is free
    std::int32_t next = none;      // entry with another look of the same landmark
  };

  const PlaceBucket& bucket(std::size_t table, const Descriptor& d) const;
  PlaceBucket& bucket(std::size_t table, const Descriptor& d);
  std::uint32_t signature(std::size_t table, const Descriptor& d) const;
  bool wants(int landmark, const Descriptor& look) const;
  void insert(int landmark, const Descriptor& look);
  void erase(std::int32_t entry);
  void tidy(const Map& map);
  /// Landmarks that look like the feature, each once, by id; `near` is scratch.
  void find(const Map& map, const Descriptor& feature, std::vector<std::int32_t>& near,
            std::vector<int>& landmarks) const;

  const PlaceIndexOptions options_;
  const std::size_t lanes_apart_;
  std::vector<PlaceBucket> buckets_;  // table after table
  std::vector<Entry> entries_;
  std::vector<std::int32_t> free_;
  IdTable<std::int32_t> first_entry_;  // by landmark
  std::size_t next_to_tidy_ = 0;
  std::int64_t followed_ = 0;
  std::int64_t at_tidy_start_ = 0;  // fusions when tidying last began with the first entry
};

}  // namespace dkp_slam

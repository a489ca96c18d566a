#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/map/map.h"

namespace dkp_slam {

class OptionList;

struct LoopDetectorOptions {
  /// Keyframes in a row that must have seen the same other place (Mur-Artal et al. 2015, section
  /// VII-A). Each group of candidates is followed on its own.
  int consistent = 3;
  std::size_t candidates = 5;
  int least_votes = 15;  ///< of a keyframe that may close a loop
  /// Features of the keyframe that one frame asks the place index about, so that none waits for
  /// long (2,000 keyframes with 280,000 landmarks: about 1.5 ms).
  std::size_t features_per_frame = 250;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Notices that the camera is back where it was, though the map does not know it: what the newest
/// keyframe sees looks like a place that neither it nor any keyframe next to it is tied to.
class LoopDetector {
 public:
  explicit LoopDetector(const LoopDetectorOptions& options = {}) : options_(options) {}

  /// Begins with a keyframe; to be called with each new one in turn. What was begun is dropped.
  void look_at(int keyframe);
  /// A bounded part of it. Once that was the last: keyframes to close a loop with, best first.
  std::optional<std::vector<int>> advance(const Map& map, const PlaceIndex& places);
  /// Whether there is more to do for the keyframe.
  bool looking() const { return keyframe_ >= 0; }

  /// Forgets the keyframes so far, as after a loop was closed.
  void reset() {
    keyframe_ = -1;
    groups_.clear();
  }

 private:
  struct Group {
    std::vector<int> keyframes;  // ascending
    int seen = 0;                // keyframes in a row that led to it
  };

  void count_votes(const Map& map, const PlaceIndex& places, std::span<const Descriptor> features);
  std::vector<int> closing_keyframes(const Map& map, const PlaceIndex& places);

  const LoopDetectorOptions options_;
  int keyframe_ = -1;  // looked at, -1 for none
  std::size_t next_feature_ = 0;
  std::vector<PlaceCandidate> votes_;  // of its features so far, by keyframe
  std::vector<Group> groups_;          // of the keyframe before
};

}  // namespace dkp_slam

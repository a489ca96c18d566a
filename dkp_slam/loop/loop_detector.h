#pragma once

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

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Notices that the camera is back where it was, though the map does not know it: what the newest
/// keyframe sees looks like a place that neither it nor any keyframe next to it is tied to.
class LoopDetector {
 public:
  explicit LoopDetector(const LoopDetectorOptions& options = {}) : options_(options) {}

  /// To be called with each new keyframe in turn. Keyframes to close a loop with, best first.
  std::vector<int> detect(const Map& map, const PlaceIndex& places, int keyframe);

  /// Forgets the keyframes so far, as after a loop was closed.
  void reset() { groups_.clear(); }

 private:
  struct Group {
    std::vector<int> keyframes;  // ascending
    int seen = 0;                // keyframes in a row that led to it
  };

  const LoopDetectorOptions options_;
  std::vector<Group> groups_;  // of the keyframe before
};

}  // namespace dkp_slam

#pragma once

#include <cstddef>
#include <functional>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/feature/orb_extractor.h"

namespace dkp_slam {

class OptionList;

struct FeatureRefillOptions {
  int below = 500;     ///< static features; an image with fewer gets more
  int features = 800;  ///< spread over what is not dynamic, with those that are known already
  /// From what is dynamic, pixels: corners on an outline move with the person, and a descriptor
  /// takes in what lies 15 pixels (of its level) around.
  int margin = 14;
  /// The same where surfaces were seen standing still before: what a mask misses is none of these.
  int known_below = 900;
  int known_features = 600;
  int known_inside = 4;  ///< pixels from what is not known: feet stand on a floor that is

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// More features where people leave little of the room to be seen: the extractor spreads its own
/// over the whole image, and most of them lie on the people then.
class FeatureRefill {
 public:
  FeatureRefill(const OrbOptions& orb, const FeatureRefillOptions& options);

  /// What is asked where it matters.
  struct Room {
    /// The surfaces that are known to stand still, CV_8UC1 of the image's size, not 0 there; empty:
    /// none.
    std::function<cv::Mat()> known;
    /// The features from this one on were added, as static: sets the verdict of those that are
    /// seen to move.
    std::function<void(std::size_t first)> judge;
  };
  /// Appends to `features`, and their verdict to `dynamics`, where too few of them are static and
  /// what is doubtful hides others. Deterministic.
  void refill(const Room& room, OrbFeatures& features, FrameDynamics& dynamics) const;

 private:
  FeatureRefillOptions options_;
  OrbExtractor extractor_, known_extractor_;
};

}  // namespace dkp_slam

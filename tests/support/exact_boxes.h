#pragma once

#include "dkp_slam/synth/true_detections.h"
#include "tests/support/recording.h"

namespace dkp_slam::testing {

/// Knows the exact box of everybody, and no silhouette; sees nothing from one frame to another
/// (exclusive).
class ExactBoxes : public Detector {
 public:
  explicit ExactBoxes(const Recording& room, int blind_from = 0, int blind_to = 0)
      : room_(room), blind_from_(blind_from), blind_to_(blind_to) {}
  std::string name() const override { return "exact boxes"; }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    if (frame.index >= blind_from_ && frame.index < blind_to_) return {};
    return true_detections(room_.truths.at(static_cast<std::size_t>(frame.index)));
  }

 private:
  const Recording& room_;
  int blind_from_, blind_to_;
};

}  // namespace dkp_slam::testing

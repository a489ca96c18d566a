#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/lucas_kanade.h"

namespace dkp_slam {

class OptionList;

struct FlowOptions {
  /// Pixels; larger windows straddle outlines of people. Eight columns are taken at a time, and 12
  /// rows do as well as 16.
  int window_width = 16, window_height = 12;
  int levels = 2;  ///< coarser pyramid levels: such windows then reach 28 px about the guess
  int iterations = 10;
  double epsilon = 0.1;  ///< pixels: finer steps are under LK's noise (0.16 to 0.32 px)
  /// Largest distance of a point tracked there and back from where it began, pixels.
  double forward_backward = 1.0;
  int history = 5;  ///< earlier frames that are kept

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Where the points of the newest frame were in an earlier one.
struct FlowResult {
  std::vector<cv::Point2f> previous;  ///< raw pixels of the earlier frame
  std::vector<std::uint8_t> tracked;  ///< 1 where the point was found there and back
};

/// Backward pyramidal Lucas-Kanade flow (Bouguet 2001) with the pyramids of recent frames.
/// The paper tracks the earlier features forward; the other way round each current feature gets
/// its own flow, with nothing to associate.
class BackwardFlow {
 public:
  explicit BackwardFlow(const FlowOptions& options) : options_(options) {}

  /// Makes `grey` (CV_8UC1) the newest frame.
  void push(const cv::Mat& grey);
  /// Earlier frames at hand, at most `history`.
  int earlier_frames() const { return static_cast<int>(pyramids_.size()) - 1; }
  /// Tracks raw pixels of the newest frame into the one `frames_back` (1 or more, at most
  /// `earlier_frames()`) before. `guess` holds where they are expected there; empty for no idea.
  FlowResult track(const std::vector<cv::Point2f>& points, int frames_back,
                   const std::vector<cv::Point2f>& guess) const;

 private:
  LucasKanadeSearch search(int levels) const;

  FlowOptions options_;
  std::deque<std::vector<cv::Mat>> pyramids_;  // newest first
};

}  // namespace dkp_slam

#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Tells which points beside a mask are at the mask's depth.
class MaskDepth {
 public:
  /// `reach`: pixels from a mask at most; `tolerance`: share of the depth.
  MaskDepth(int reach, double tolerance);

  /// CV_8UC1, image size, not 0 where a point may be at a mask's depth: within a square of `reach`
  /// about each pixel of `masks` (CV_8UC1, not 0 in a mask).
  cv::Mat candidates(const cv::Mat& masks) const;
  /// Whether the depth at `pixel` is that of the nearest pixel of a mask that has one, within
  /// `reach`. False where one of both is not known. `depth`: CV_32FC1, metres, 0 where unknown.
  bool is_shared(const cv::Mat& masks, const cv::Mat& depth, cv::Point pixel) const;

 private:
  int reach_;
  float tolerance_;
  std::vector<cv::Point> offsets_;  // within reach, the nearest first
};

}  // namespace dkp_slam

#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/startle.h"

namespace dkp_slam {

class OptionList;

/// Between looks objects are carried by flow and depth, which is as good while little moves; where
/// people fill the image a look late costs frames.
struct LookOptions {
  /// Seconds between two looks, at least, while people and animals cover less than `many` of the
  /// image; every second one at 30 Hz. 0: every image.
  double interval = 0.05;
  double many = 0.15;
  /// Share of the image that is nearer than all that lay about it in the image before: somebody
  /// steps into the view, and it looks at once.
  double nearer = startling_share;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Says which images a detector looks at, from what it saw in those before.
class LookSchedule {
 public:
  explicit LookSchedule(const LookOptions& options) : options_(options), startle_(options.nearer) {}

  /// Whether the image of `time` (seconds) is one of them; asked once for every image, in order,
  /// with its depth (CV_32FC1, metres, 0 where unknown; may be empty). Where somebody may have
  /// stepped into the view (`Startle::by`), or the clock was set back, it is.
  bool due(double time, const cv::Mat& depth = {});
  /// What was seen in the image that was last due, which is of that size.
  void saw(const std::vector<Detection>& detections, const cv::Size& image);

 private:
  LookOptions options_;
  Startle startle_;
  std::optional<double> start_;  // seconds
  double last_look_ = 0.0;       // seconds
  double share_ = 1.0;           // of the image that people cover
};

}  // namespace dkp_slam

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

struct MaskScoreOptions {
  /// True regions below this share of the image are not scored: a person that small, or a sliver of
  /// one at the image's edge, hardly disturbs the tracking.
  double min_region_share = 0.05;
};

/// How well an estimated mask covers one true region.
struct RegionScore {
  double share = 0.0;  ///< of the image's pixels that the true region takes
  double iou = 0.0;    ///< intersection over union, 0 to 1
};

/// Compares each connected true region (8-neighbours) of at least the least share with the
/// connected regions of the estimate that touch it. Regions of the estimate that touch no true
/// region do not count: the truth does not hold every person. Pixels of other true regions that the
/// estimate covers too are not counted against it. Both masks CV_8UC1 of one size, anything but 0
/// is inside; an empty estimate is a mask without regions. Throws `Error` for other types or sizes.
std::vector<RegionScore> score_mask(const cv::Mat& truth, const cv::Mat& estimate,
                                    const MaskScoreOptions& options = {});

/// What became of a frame's features, counted by where the truth says they are.
struct FeatureCounts {
  std::size_t inside = 0;          ///< in the true mask: dynamic
  std::size_t inside_removed = 0;  ///< of them, rightly removed
  std::size_t outside = 0;         ///< outside it: static
  std::size_t outside_kept = 0;    ///< of them, rightly kept
};

/// Counts features against the true mask (CV_8UC1). A feature belongs to the pixel that its
/// position (u, v) rounds to; positions outside the image are static. `kept` has one entry per
/// position. Throws `Error` for another type or when the counts differ.
FeatureCounts count_features(const cv::Mat& truth, std::span<const cv::Point2f> positions,
                             const std::vector<bool>& kept);

/// Gathers the scores of a sequence's frames.
class MaskScoreTally {
 public:
  /// Adds a frame. One without a region to score counts only in its features.
  void add(std::span<const RegionScore> regions, const FeatureCounts& features = {});

  /// Frames with a region to score.
  std::size_t frames() const { return frames_; }
  /// Mean over those frames of the mean IoU of the frame's regions; nothing without such a frame.
  std::optional<double> mean_iou() const;
  /// Share of dynamic features removed, 0 to 1; nothing without a dynamic feature.
  std::optional<double> removed_share() const;
  /// Share of static features kept, 0 to 1; nothing without a static feature.
  std::optional<double> kept_share() const;
  const FeatureCounts& features() const { return features_; }

 private:
  std::size_t frames_ = 0;
  double iou_sum_ = 0.0;
  FeatureCounts features_;
};

}  // namespace dkp_slam

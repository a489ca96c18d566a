#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/removal/feature_dynamics.h"

namespace dkp_slam {

class OptionList;

struct RegionOptions {
  float weight_low = 1.0F;  ///< W of low regions
  /// W in the mask of an object whose class weight is 10; classes below scale with it. The paper's
  /// example is 10, which with eps = 1 px asks for D under 0.1 px, below the flow's own noise.
  float weight_high = 4.0F;
  /// Eq. 6 as printed, which gives the low weight at the mask's edge and the high one far from it
  /// and so contradicts its own text. Default: the other way round.
  bool printed_equation = false;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// W of an object's mask for the weight (1 to 10) of its class.
float object_weight(float class_weight, const RegionOptions& options);

/// Eq. 6: W of a feature in a suspicious region at `distance` px from the mask, where the farthest
/// feature of the box is at `max_distance`, for the share `suspicious_share` (S) of the box.
float suspicious_weight(float distance, float max_distance, float suspicious_share,
                        float weight_high, const RegionOptions& options);

/// One object's regions as the classification sees them.
struct ObjectRegions {
  cv::Rect2f box;        ///< pixels
  float weight = 10.0F;  ///< W of its class
  bool moves_by_itself = true;
};

/// Label (CV_8UC1) at a raw pixel, which may lie just outside the image.
int label_at(const cv::Mat& labels, const cv::Point2f& pixel);

/// CV_8UC1, 255 in every mask and within `margin` pixels (rows, columns) of one. `labels` is
/// CV_8UC1.
cv::Mat masks_and_outlines(const cv::Mat& labels, int margin);

/// Region of every keypoint (raw pixels). `labels` is CV_8UC1, image size: 0 outside the masks,
/// i + 1 in the mask of objects[i].
void assign_regions(const std::vector<cv::Point2f>& keypoints,
                    const std::vector<ObjectRegions>& objects, const cv::Mat& labels,
                    std::vector<FeatureDynamics>& features);

/// W of every keypoint, for the same input. Where boxes overlap the larger weight counts.
void assign_weights(const std::vector<cv::Point2f>& keypoints,
                    const std::vector<ObjectRegions>& objects, const cv::Mat& labels,
                    const RegionOptions& options, std::vector<FeatureDynamics>& features);

}  // namespace dkp_slam

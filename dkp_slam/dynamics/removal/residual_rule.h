#pragma once

#include <string>
#include <vector>

#include "dkp_slam/dynamics/removal/feature_classifier.h"
#include "dkp_slam/dynamics/removal/mask_depth.h"
#include "dkp_slam/dynamics/removal/removal_options.h"

namespace dkp_slam {

/// Removes the masks of what moves by itself with their outlines and what is beside them at their
/// depth, and of the rest of all boxes the features that are seen to move: off the place where the
/// measured ego-motion puts what is static, by more than its noise. What flow cannot follow is no
/// proof. Where that leaves too few for a pose, those that move least come back, but for masks and
/// outlines. Outside the boxes single features prove nothing either: where a hand moves the camera
/// in a still room 6 to 12% of the features are off by more than 2 px, and half of those of a
/// blurred image, for flow slips along edges and on patterns that repeat. What really moves there
/// is a surface, and becomes an object (`MovingSurfaces`).
class ResidualRule : public FeatureClassifier {
 public:
  explicit ResidualRule(const RemovalOptions& options)
      : options_(options), mask_depth_(options.depth_margin, options.depth_tolerance) {}
  std::string name() const override { return "residual rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;
  bool judges_one_by_one() const override { return true; }
  cv::Mat doubtful(const RemovalInput& input) const override;

 private:
  /// How far a feature is off, in units of what a static one may be: from 1 on it moves. `noise`:
  /// sigma of the static points' residuals in this frame, pixels.
  float motion(const FeatureDynamics& f, float long_residual, float noise) const;

  RemovalOptions options_;
  MaskDepth mask_depth_;
};

}  // namespace dkp_slam

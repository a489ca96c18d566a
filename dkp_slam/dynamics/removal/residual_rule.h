#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dkp_slam/dynamics/removal/feature_classifier.h"
#include "dkp_slam/dynamics/removal/removal_options.h"

namespace dkp_slam {

/// Removes the masks of what moves by itself, and of the rest of all boxes the features that are
/// seen to move: off the place where the measured ego-motion puts what is static, by more than its
/// noise. What flow cannot follow is no proof. Outside the boxes single features prove nothing
/// either: where a hand moves the camera in a still room 6 to 12% of the features are off by more
/// than 2 px, and half of those of a blurred image, for flow slips along edges and on patterns that
/// repeat. What really moves there is a surface, and becomes an object (`MovingSurfaces`).
class ResidualRule : public FeatureClassifier {
 public:
  explicit ResidualRule(const RemovalOptions& options) : options_(options) {}
  std::string name() const override { return "residual rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;

  /// What the decision needs to know of a feature beside its own FeatureDynamics.
  struct Evidence {
    bool self_moving = false;  ///< on an object that moves by itself
    bool at_outline = false;   ///< within `mask_margin` of the mask of something of the kind
    float noise = 0.0F;        ///< pixels, sigma of the static points' residuals in this frame
    float long_residual = std::numeric_limits<float>::quiet_NaN();  ///< pixels, longer baseline
  };
  bool is_static(const FeatureDynamics& feature, const Evidence& evidence) const;

 private:
  RemovalOptions options_;
};

}  // namespace dkp_slam

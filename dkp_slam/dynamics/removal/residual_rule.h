#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dkp_slam/dynamics/removal/feature_classifier.h"
#include "dkp_slam/dynamics/removal/removal_options.h"

namespace dkp_slam {

/// Removes the masks of what moves by itself, and elsewhere the features that are off the place
/// where the measured ego-motion puts what is static.
class ResidualRule : public FeatureClassifier {
 public:
  explicit ResidualRule(const RemovalOptions& options) : options_(options) {}
  std::string name() const override { return "residual rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;

  /// What the decision needs to know of a feature beside its own FeatureDynamics.
  struct Evidence {
    bool self_moving = false;  ///< on an object that moves by itself
    bool at_outline = false;   ///< within `mask_margin` of a mask
    float long_residual = std::numeric_limits<float>::quiet_NaN();  ///< pixels, longer baseline
  };
  bool is_static(const FeatureDynamics& feature, const Evidence& evidence) const;

 private:
  RemovalOptions options_;
};

}  // namespace dkp_slam

#pragma once

#include <string>
#include <vector>

#include "dkp_slam/dynamics/removal/epipolar.h"
#include "dkp_slam/dynamics/removal/feature_classifier.h"

namespace dkp_slam {

/// Algorithm 2: static when the region's weight W (Eq. 6) times the distance D (Eq. 5) from the
/// epipolar line is below eps. Features that flow cannot follow are kept outside boxes and dropped
/// inside.
class EpipolarRule : public FeatureClassifier {
 public:
  /// `epsilon` in pixels.
  EpipolarRule(const EpipolarOptions& epipolar, const RegionOptions& regions, float epsilon)
      : epipolar_(epipolar), regions_(regions), epsilon_(epsilon) {}
  std::string name() const override { return "region and epipolar rule"; }
  /// Sets weight and epipolar distance too.
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;
  /// The decision about a feature whose weight and distance are known.
  bool is_static(const FeatureDynamics& feature) const;

 private:
  void measure(const FeatureMotion& motion, std::vector<FeatureDynamics>& features) const;

  EpipolarOptions epipolar_;
  RegionOptions regions_;
  float epsilon_;
};

}  // namespace dkp_slam

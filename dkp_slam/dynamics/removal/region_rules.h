#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dkp_slam/dynamics/removal/feature_classifier.h"

namespace dkp_slam {

/// For every feature, 1 where an object that moves by itself has it: in its mask, or in its box and
/// in no mask.
std::vector<std::uint8_t> on_self_moving(const RemovalInput& input);

/// CV_8UC1, image size: labels of the objects that move by themselves.
cv::Mat masks_of_self_moving(const RemovalInput& input);

/// Removes what lies in the box of an object that moves by itself.
class BoxRule : public FeatureClassifier {
 public:
  std::string name() const override { return "box rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;
};

/// Removes what lies in the mask of an object that moves by itself.
class MaskRule : public FeatureClassifier {
 public:
  std::string name() const override { return "mask rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;
  cv::Mat doubtful(const RemovalInput& input) const override;
};

/// Removes what lies in a mask that was given with the image, or within `margin` pixels of one.
class GivenMaskRule : public FeatureClassifier {
 public:
  explicit GivenMaskRule(int margin) : margin_(margin) {}
  std::string name() const override { return "given mask rule"; }
  void classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const override;
  cv::Mat doubtful(const RemovalInput& input) const override;

 private:
  int margin_;
};

}  // namespace dkp_slam

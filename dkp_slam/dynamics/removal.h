#pragma once

#include <vector>

#include "dkp_slam/dynamics/frame_dynamics.h"

namespace dkp_slam {

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (modes dkp).
  float epsilon = 1.0F;
  /// Classes of this weight and more ("people, animals, motion") are removed without evidence.
  float certain_weight = 8.0F;
  /// Largest motion residual of a static point, pixels (mode dkp+): LK's noise and the depth's.
  float residual_low = 2.0F;         ///< outside boxes
  float residual_suspicious = 1.0F;  ///< in a box, outside its mask
  float residual_object = 1.0F;      ///< on things of middle weight
};

/// What the classification needs to know about a feature beside its own FeatureDynamics.
struct FeatureEvidence {
  float object_weight = 0.0F;  ///< class weight of its object; 0 in low regions
  bool proved_static = false;  ///< showed no motion against a longer baseline, frames running
};

/// Sets `is_static` of every feature as the mode asks (Algorithm 2 for `dkp`). `evidence` runs
/// parallel to `features`.
void classify(DynamicsMode mode, const RemovalOptions& options,
              const std::vector<FeatureEvidence>& evidence,
              std::vector<FeatureDynamics>& features);

}  // namespace dkp_slam

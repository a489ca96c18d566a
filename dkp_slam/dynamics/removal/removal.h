#pragma once

#include <limits>
#include <vector>

#include "dkp_slam/dynamics/removal/feature_dynamics.h"

namespace dkp_slam {

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (modes dkp).
  float epsilon = 1.0F;
  /// Classes of this weight and more ("people, animals, motion") are removed without evidence.
  float certain_weight = 8.0F;
  /// Features this near to a mask go with it, pixels (mode dkp+): corners on an outline move with
  /// the person, and depth is that ragged there.
  int mask_margin = 2;
  /// Largest motion residual of a static point, pixels (mode dkp+): LK's noise and the depth's.
  float residual_low = 2.0F;         ///< outside boxes
  float residual_suspicious = 1.5F;  ///< in a box, outside its mask
  float residual_object = 1.0F;      ///< on things of middle weight
  float residual_long = 2.5F;        ///< in boxes, over the longer baseline
  /// Residuals by which a feature counts as moving or still when surfaces are judged, pixels, from
  /// frame to frame and over the longer baseline. Between them it says nothing.
  float moving_short = 1.5F;
  float moving_long = 2.5F;
  float still_long = 1.2F;
  float noise_factor =
      4.0F;  ///< but moving only above so many sigma of the static points' residuals
  /// Features outside boxes from which the camera's motion is measured; with fewer, what lies on
  /// the room's planes in boxes helps.
  int enough_outside = 150;
  /// A surface outside all boxes that is proved to move becomes an object by itself when it takes
  /// at least this share of the image; smaller ones lose their points one by one.
  double moving_surface_share = 0.01;
  double moving_surface_seconds = 0.09;  ///< keeps moving so long: one bad frame makes no person
  int moving_surface_points = 10;        ///< and bears so many features that move
};

/// What the classification needs to know about a feature beside its own FeatureDynamics.
struct FeatureEvidence {
  float object_weight = 0.0F;  ///< class weight of its object; 0 in low regions
  float long_residual = std::numeric_limits<float>::quiet_NaN();  ///< pixels, longer baseline
  bool at_outline = false;  ///< within `mask_margin` of the mask of somebody who moves by himself
};

/// Sets `is_static` of every feature as the mode asks (Algorithm 2 for `dkp`). `evidence` runs
/// parallel to `features`.
void classify(DynamicsMode mode, const RemovalOptions& options,
              const std::vector<FeatureEvidence>& evidence, std::vector<FeatureDynamics>& features);

}  // namespace dkp_slam

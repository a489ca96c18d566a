#pragma once

namespace dkp_slam {

class OptionList;

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (region rule).
  float epsilon = 1.0F;
  /// Features this near to a mask go with it, pixels (residual rule): corners on an outline move
  /// with the person.
  int mask_margin = 1;
  /// So do, farther from it, those that are as far from the camera as the mask is where it is
  /// nearest to them, within this share of the depth: masks end short of a surface's own end, and
  /// have pieces cut out of them.
  int depth_margin = 16;
  double depth_tolerance = 0.03;
  /// Features this near to a mask that was given with the image go with it, pixels.
  int given_margin = 2;
  /// Motion residual, pixels, from which on a feature in a box is seen to move, from one frame
  /// to the next and over the longer baseline: well above flow's noise and the depth's, for a
  /// static one that goes is missed more than a slow one that stays...
  float residual = 4.0F;
  float residual_long = 6.0F;
  /// ... and at least so many sigma of the static points' residuals in the frame.
  float noise_factor = 4.0F;
  /// With fewer static features in the image those that move least come back.
  int least_static = 200;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

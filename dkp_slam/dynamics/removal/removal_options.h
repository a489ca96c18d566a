#pragma once

namespace dkp_slam {

class OptionList;

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (region rule).
  float epsilon = 1.0F;
  /// Features this near to a mask go with it, pixels (residual and given mask rules): corners on an
  /// outline move with the person, and depth is that ragged there.
  int mask_margin = 2;
  /// Motion residual, pixels, from which on a feature in a box is seen to move: flow's noise and
  /// the depth's, from one frame to the next and over the longer baseline...
  float residual = 1.5F;
  float residual_long = 2.5F;
  /// ... and at least so many sigma of the static points' residuals in the frame.
  float noise_factor = 4.0F;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

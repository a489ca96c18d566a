#pragma once

namespace dkp_slam {

class OptionList;

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (region rule).
  float epsilon = 1.0F;
  /// Features this near to a mask go with it, pixels (residual and given mask rules): corners on an
  /// outline move with the person, and depth is that ragged there.
  int mask_margin = 2;
  /// Largest motion residual of a static point, pixels (residual rule): LK's noise and the depth's.
  float residual_low = 2.0F;         ///< outside boxes
  float residual_suspicious = 1.5F;  ///< in a box, outside its mask
  float residual_object = 1.0F;      ///< on things of middle weight
  float residual_long = 2.5F;        ///< in boxes, over the longer baseline

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

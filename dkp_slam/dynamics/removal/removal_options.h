#pragma once

namespace dkp_slam {

class OptionList;

struct RemovalOptions {
  /// eps of Algorithm 2, pixels: static when D * W is below it (region rule).
  float epsilon = 1.0F;
  /// Features this near to a mask go with it, pixels (dkp+ and given masks): corners on an outline
  /// move with the person, and depth is that ragged there.
  int mask_margin = 2;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

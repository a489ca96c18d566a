#pragma once

#include <cstdint>
#include <limits>

namespace dkp_slam {

/// Where a feature lies (paper §3.5 step 1).
enum class Region : std::uint8_t {
  low,         ///< outside every box
  suspicious,  ///< in a box, outside its mask
  high,        ///< in a mask
};

/// What the dynamic point removal found about one feature of the current frame.
struct FeatureDynamics {
  Region region = Region::low;
  bool is_static = true;
  bool tracked = false;  ///< optical flow found it in the previous frame, forward and backward
  float weight = 1.0F;   ///< W, Eq. 6; told by the epipolar rule alone
  /// D of Eq. 5, pixels; NaN where the feature was not tracked or there was no fundamental matrix,
  /// and under all rules but the epipolar one.
  float epipolar_distance = std::numeric_limits<float>::quiet_NaN();
  /// Distance, pixels, from where a static point would have moved; NaN where it cannot be told.
  float motion_residual = std::numeric_limits<float>::quiet_NaN();
};

}  // namespace dkp_slam

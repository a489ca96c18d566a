#pragma once

#include <vector>

#include "dkp_slam/calibration/window.h"

namespace dkp_slam {

/// A mean over similar sightings.
struct ProfileBin {
  double at = 0.0;  ///< what the sightings have in common
  double value = 0.0;
  double sigma = 0.0;  ///< standard deviation of `value`
};

/// How much later than the middle row each row saw what it saw: seconds (`value`), over the row's
/// place from -1/2 to 1/2 (`at`). A line through 0 with the readout as slope, where all is right.
std::vector<ProfileBin> row_profile(const std::vector<Window>& windows,
                                    const Parameters& parameters);

/// By how much depth images differ from the motion at their time stamps (`value`, 1/metre of
/// inverse depth) over how fast that depth changes (`at`, 1/(metre second)): a line with the delay
/// as slope. `parameters` give the bias.
std::vector<ProfileBin> depth_profile(const std::vector<Window>& windows,
                                      const Parameters& parameters);

}  // namespace dkp_slam

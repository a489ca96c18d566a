#pragma once

#include <vector>

#include "dkp_slam/calibration/parameters.h"
#include "dkp_slam/calibration/window.h"

namespace dkp_slam {

struct Adjustment {
  Parameters parameters = Parameters::Zero();
  /// Of the free ones; of the others the rows are zero.
  ParameterMatrix covariance = ParameterMatrix::Zero();
  MeasuredNoise noise;
  int sightings = 0, depths = 0;
  bool converged = false;
};

/// Finds the parameters that are `free`, and with them each window's motion and landmarks, which it
/// changes: least squares of pixels and inverse depths (Levenberg and Marquardt's, landmarks and
/// motions eliminated window by window), robust after Cauchy, weighted by the noise that turns out.
///
/// The standard deviations: windows know nothing of each other, so that the scatter of what each of
/// them wants says how sure the result is, also where the errors within a window hang together:
/// the jackknife over windows (Tukey 1958); those of the least squares where they are larger.
Adjustment adjust_windows(std::vector<Window>& windows, const Camera& camera,
                          const Parameters& start, const ParameterChoice& free);

}  // namespace dkp_slam

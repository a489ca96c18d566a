#pragma once

#include <atomic>

#include "dkp_slam/optimization/bundle_problem.h"

namespace dkp_slam {

class OptionList;

struct BundleOptions {
  int iterations = 10;
  /// Sightings beyond the chi-square bound after half of the iterations are left out of the rest.
  bool drop_outliers = true;
  /// A pose with fewer sightings of points that others see, too, stays where it is: a handful of
  /// points, wrong ones among them, can throw it metres away.
  int least_shared = 10;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Levenberg and Marquardt's method, landmarks eliminated by the Schur complement, on one thread:
/// several would add in another order and the result would differ from run to run. A system of up
/// to 60 free poses is dense and solved by our own code (`solve_dense_bundle`), a larger one by
/// Ceres. `stop`, when given and set, ends it early.
BundleSolution adjust_bundle(const Camera& camera, const MeasurementModel& model,
                             const BundleProblem& problem, const BundleOptions& options = {},
                             const std::atomic<bool>* stop = nullptr);

}  // namespace dkp_slam

#pragma once

#include <atomic>

#include "dkp_slam/optimization/bundle_problem.h"

namespace dkp_slam {

/// One run of Levenberg and Marquardt's method over the sightings that are not outliers: landmarks
/// eliminated by the Schur complement (Triggs et al. 2000, §6.1), the poses' system dense, Huber's
/// weight on pixels and Cauchy's on depth. Costs and steps are Ceres' (`solve_sparse_bundle`),
/// which it takes a third of the time of where few poses are free. Moves `state` from where it is.
/// False when it was stopped or the numbers are no use.
bool solve_dense_bundle(const Camera& camera, const MeasurementModel& model,
                        const BundleProblem& problem, int iterations, const std::atomic<bool>* stop,
                        BundleSolution& state);

}  // namespace dkp_slam

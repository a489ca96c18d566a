#pragma once

#include <atomic>

#include "dkp_slam/optimization/bundle_problem.h"

namespace dkp_slam {

/// `solve_dense_bundle` by Ceres, on one thread: where many poses are free their system is sparse.
bool solve_sparse_bundle(const Camera& camera, const MeasurementModel& model,
                         const BundleProblem& problem, int iterations,
                         const std::atomic<bool>* stop, BundleSolution& state);

}  // namespace dkp_slam

#include "dkp_slam/optimization/bundle_adjustment.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/optimization/dense_bundle.h"
#include "dkp_slam/optimization/nearest_depth.h"
#include "dkp_slam/optimization/sparse_bundle.h"

namespace dkp_slam {
namespace {

void mark_outliers(const Camera& camera, const MeasurementModel& model,
                   const BundleProblem& problem, BundleSolution& solution) {
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const auto& s = problem.sightings[i];
    const Eigen::Vector3d p = solution.poses[static_cast<std::size_t>(s.pose)].camera_from_world *
                              solution.points[static_cast<std::size_t>(s.point)].position;
    const double chi2 = p.z() < nearest_depth ? INFINITY
                                              : (camera.project(p) - s.seen.pixel).squaredNorm() /
                                                    (s.seen.pixel_sigma * s.seen.pixel_sigma);
    solution.outlier[i] = chi2 > model.pixel_chi2;
  }
}

/// Puts poses back and holds them, with the points that they alone see, where too few of their
/// sightings are shared.
void hold_loose_poses(const BundleProblem& problem, int least_shared, BundleSolution& solution) {
  std::vector<int> seen(problem.points.size(), 0), shared(problem.poses.size(), 0);
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    seen[static_cast<std::size_t>(problem.sightings[i].point)] += solution.outlier[i] ? 0 : 1;
  }
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const BundleProblem::Sighting& s = problem.sightings[i];
    const bool with_others = !solution.outlier[i] && seen[static_cast<std::size_t>(s.point)] > 1;
    shared[static_cast<std::size_t>(s.pose)] += with_others ? 1 : 0;
  }
  std::vector<char> loose(problem.poses.size(), 0);
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (problem.poses[i].fixed || shared[i] >= least_shared) continue;
    loose[i] = 1;
    solution.poses[i] = problem.poses[i];
    solution.poses[i].fixed = true;
  }
  for (const BundleProblem::Sighting& s : problem.sightings) {
    const auto point = static_cast<std::size_t>(s.point);
    if (loose[static_cast<std::size_t>(s.pose)] && seen[point] < 2) {
      solution.points[point] = problem.points[point];
    }
  }
}

}  // namespace

BundleSolution adjust_bundle(const Camera& camera, const MeasurementModel& model,
                             const BundleProblem& problem, const BundleOptions& options,
                             const std::atomic<bool>* stop) {
  BundleSolution solution{problem.poses, problem.points,
                          std::vector<char>(problem.sightings.size(), 0), false};
  if (problem.sightings.empty()) return solution;
  const int first = options.drop_outliers ? options.iterations / 2 : options.iterations;
  constexpr auto dense_limit = 60;  // poses; above, the reduced system is sparse enough to gain
  const auto free_poses = std::count_if(problem.poses.begin(), problem.poses.end(),
                                        [](const auto& p) { return !p.fixed; });
  const auto solve = free_poses <= dense_limit ? solve_dense_bundle : solve_sparse_bundle;
  const auto solve_and_judge = [&](int iterations) {
    const bool good = solve(camera, model, problem, iterations, stop, solution);
    mark_outliers(camera, model, problem, solution);
    hold_loose_poses(problem, options.least_shared, solution);
    return good;
  };
  hold_loose_poses(problem, options.least_shared, solution);
  bool good = solve_and_judge(first);
  if (good && options.drop_outliers && !(stop && *stop)) {
    good = solve_and_judge(options.iterations - first);
  }
  solution.usable = good && !(stop && *stop);
  return solution;
}

}  // namespace dkp_slam

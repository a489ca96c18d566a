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
  bool good = solve(camera, model, problem, first, stop, solution);
  mark_outliers(camera, model, problem, solution);
  if (good && options.drop_outliers && !(stop && *stop)) {
    good = solve(camera, model, problem, options.iterations - first, stop, solution);
    mark_outliers(camera, model, problem, solution);
  }
  solution.usable = good && !(stop && *stop);
  return solution;
}

}  // namespace dkp_slam

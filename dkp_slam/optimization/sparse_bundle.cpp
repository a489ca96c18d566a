#include "dkp_slam/optimization/sparse_bundle.h"

#include <cmath>
#include <memory>

#include <ceres/ceres.h>

#include "dkp_slam/optimization/nearest_depth.h"
#include "dkp_slam/optimization/pose_block.h"
#include "dkp_slam/optimization/stop_when_asked.h"

namespace dkp_slam {
namespace {

using PoseJacobian = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
using PointJacobian = Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>;

/// Derivative of the camera point by (translation, rotation) of a left perturbation, and by the
/// landmark, chained behind `by_point`, the residual's derivative by the camera point.
void chain(const Eigen::Matrix<double, 2, 3>& by_point, const Eigen::Quaterniond& rotation,
           const Eigen::Vector3d& p, double** jacobians) {
  if (jacobians[0]) {
    PoseJacobian j(jacobians[0]);
    j.leftCols<3>() = by_point;
    j.middleCols<3>(3) = -by_point * skew(p);
    j.col(6).setZero();
  }
  if (jacobians[1]) {
    PointJacobian j(jacobians[1]);
    j = by_point * rotation.toRotationMatrix();
  }
}

/// (u, v) reprojection error over its standard deviation.
class PixelCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  PixelCost(const Camera& camera, const Observation& seen) : camera_(camera), seen_(seen) {}
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Quaterniond rotation(x[0]);
    const Eigen::Vector3d p =
        rotation * Eigen::Vector3d(x[1]) + Eigen::Vector3d(x[0][4], x[0][5], x[0][6]);
    const double z = std::max(p.z(), nearest_depth), s = 1.0 / seen_.pixel_sigma;
    residuals[0] = s * (camera_.fx * p.x() / z + camera_.cx - seen_.pixel.x());
    residuals[1] = s * (camera_.fy * p.y() / z + camera_.cy - seen_.pixel.y());
    if (!jacobians) return true;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << s * camera_.fx / z, 0.0, -s * camera_.fx * p.x() / (z * z),  //
        0.0, s * camera_.fy / z, -s * camera_.fy * p.y() / (z * z);
    chain(by_point, rotation, p, jacobians);
    return true;
  }

 private:
  const Camera& camera_;
  Observation seen_;
};

/// Depth error over its standard deviation. The second row is always zero: all blocks then have two
/// rows, for which Ceres has a Schur eliminator of fixed size (measured: twice as fast in all).
class DepthCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  DepthCost(double depth, double sigma) : depth_(depth), scale_(1.0 / sigma) {}
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Quaterniond rotation(x[0]);
    const Eigen::Vector3d p =
        rotation * Eigen::Vector3d(x[1]) + Eigen::Vector3d(x[0][4], x[0][5], x[0][6]);
    residuals[0] = scale_ * (p.z() - depth_);
    residuals[1] = 0.0;
    if (!jacobians) return true;
    Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
    by_point(0, 2) = scale_;
    chain(by_point, rotation, p, jacobians);
    return true;
  }

 private:
  double depth_, scale_;
};

/// One Ceres run over the sightings that are not outliers.
class Round {
 public:
  Round(const Camera& camera, const MeasurementModel& model, const BundleProblem& problem,
        BundleSolution& state)
      : state_(state),
        pixel_loss_(std::sqrt(model.pixel_chi2)),
        depth_loss_(std::sqrt(model.depth_chi2)),
        ceres_(problem_options()) {
    for (const auto& p : state.poses) poses_.push_back(block_of(p.camera_from_world));
    for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
      if (!state.outlier[i]) add(camera, model, problem.sightings[i]);
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      double* block = poses_[i].data();
      if (!ceres_.HasParameterBlock(block)) continue;
      ceres_.SetManifold(block, &manifold_);
      if (state.poses[i].fixed) ceres_.SetParameterBlockConstant(block);
    }
  }

  bool solve(int iterations, const std::atomic<bool>* stop) {
    ceres::Solver::Options options;
    options.num_threads = 1;
    options.max_num_iterations = iterations;
    options.function_tolerance = 1e-5;
    options.logging_type = ceres::SILENT;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (auto& p : state_.points) {
      if (ceres_.HasParameterBlock(p.position.data()))
        ordering->AddElementToGroup(p.position.data(), 0);
    }
    for (auto& p : poses_) {
      if (ceres_.HasParameterBlock(p.data())) ordering->AddElementToGroup(p.data(), 1);
    }
    options.linear_solver_ordering = ordering;
    StopWhenAsked callback(stop);
    options.callbacks.push_back(&callback);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_, &summary);
    for (std::size_t i = 0; i < poses_.size(); ++i)
      state_.poses[i].camera_from_world = pose_of(poses_[i]);
    return summary.IsSolutionUsable();
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void add(const Camera& camera, const MeasurementModel& model, const BundleProblem::Sighting& s) {
    double* pose = poses_[static_cast<std::size_t>(s.pose)].data();
    double* point = state_.points[static_cast<std::size_t>(s.point)].position.data();
    ceres_.AddResidualBlock(new PixelCost(camera, s.seen), &pixel_loss_, pose, point);
    if (s.seen.depth > 0.0) {
      const double sigma = model.depth_sigma(camera, s.seen.depth);
      ceres_.AddResidualBlock(new DepthCost(s.seen.depth, sigma), &depth_loss_, pose, point);
    }
  }

  BundleSolution& state_;
  std::vector<PoseBlock> poses_;
  PoseManifold manifold_;
  ceres::HuberLoss pixel_loss_;
  // A wrong depth at an edge is wrong by any amount: Cauchy's loss forgets it, Huber's would not.
  ceres::CauchyLoss depth_loss_;
  ceres::Problem ceres_;
};

}  // namespace

bool solve_sparse_bundle(const Camera& camera, const MeasurementModel& model,
                         const BundleProblem& problem, int iterations,
                         const std::atomic<bool>* stop, BundleSolution& state) {
  return Round(camera, model, problem, state).solve(iterations, stop);
}

}  // namespace dkp_slam

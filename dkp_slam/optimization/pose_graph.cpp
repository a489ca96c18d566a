#include "dkp_slam/optimization/pose_graph.h"

#include <ceres/ceres.h>

#include "dkp_slam/optimization/pose_block.h"
#include "dkp_slam/optimization/stop_when_asked.h"

namespace dkp_slam {
namespace {

using BlockJacobian = Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>;

/// log(measured * from * to^-1), each part over its standard deviation.
class EdgeCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  EdgeCost(const PoseGraph::Edge& edge, const PoseGraphOptions& options)
      : measured_(edge.to_from_from) {
    scale_.head<3>().setConstant(edge.weight / options.translation_sigma);
    scale_.tail<3>().setConstant(edge.weight / options.rotation_sigma);
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Se3 off = measured_ * pose_at(x[0]) * pose_at(x[1]).inverse();
    const Vector6d tangent = off.log();
    Eigen::Map<Vector6d>{residuals} = scale_.cwiseProduct(tangent);
    if (!jacobians) return true;
    const Matrix6d outer = scale_.asDiagonal() * inverse_left_jacobian(tangent);
    if (jacobians[0]) write(outer * adjoint(measured_), jacobians[0]);
    if (jacobians[1]) write(-outer * adjoint(off), jacobians[1]);
    return true;
  }

 private:
  static Se3 pose_at(const double* x) {
    return {Eigen::Quaterniond(x), Eigen::Vector3d(x[4], x[5], x[6])};
  }
  static void write(const Matrix6d& by_perturbation, double* jacobian) {
    BlockJacobian j(jacobian);
    j.leftCols<6>() = by_perturbation;
    j.col(6).setZero();
  }

  Se3 measured_;
  Vector6d scale_;
};

}  // namespace

std::vector<Se3> optimize_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options,
                                     const std::atomic<bool>* stop) {
  std::vector<Se3> poses;
  std::vector<PoseBlock> blocks;
  for (const PoseGraph::Node& n : graph.nodes) {
    poses.push_back(n.camera_from_world);
    blocks.push_back(block_of(n.camera_from_world));
  }
  if (graph.edges.empty() || (stop && *stop)) return poses;
  PoseManifold manifold;
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (const PoseGraph::Edge& e : graph.edges) {
    problem.AddResidualBlock(new EdgeCost(e, options), nullptr,
                             blocks[static_cast<std::size_t>(e.from)].data(),
                             blocks[static_cast<std::size_t>(e.to)].data());
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!problem.HasParameterBlock(blocks[i].data())) continue;
    problem.SetManifold(blocks[i].data(), &manifold);
    if (graph.nodes[i].fixed) problem.SetParameterBlockConstant(blocks[i].data());
  }
  ceres::Solver::Options solver;
  solver.num_threads = 1;
  solver.max_num_iterations = options.iterations;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  StopWhenAsked callback(stop);
  solver.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable() || (stop && *stop)) return poses;
  for (std::size_t i = 0; i < blocks.size(); ++i) poses[i] = pose_of(blocks[i]);
  return poses;
}

}  // namespace dkp_slam

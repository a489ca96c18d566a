#include "dkp_slam/evaluation/absolute_error.h"

#include <fmt/format.h>
#include <Eigen/SVD>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// Points as columns, metres.
using Points = Eigen::Matrix3Xd;

/// The rigid motion that takes `from` nearest to `to`, column by column.
Se3 align(const Points& from, const Points& to) {
  const Eigen::Vector3d from_mean = from.rowwise().mean();
  const Eigen::Vector3d to_mean = to.rowwise().mean();
  const Eigen::Matrix3d covariance =
      (to.colwise() - to_mean) * (from.colwise() - from_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // A reflection can fit better than any rotation; turning the weakest axis over forbids it.
  Eigen::Matrix3d proper = Eigen::Matrix3d::Identity();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) proper(2, 2) = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * proper * svd.matrixV().transpose();
  const Eigen::Quaterniond unit = Eigen::Quaterniond(rotation).normalized();
  return {unit, to_mean - unit * from_mean};
}

[[noreturn]] void fail_without_overlap(std::span<const StampedPose> truth,
                                       std::span<const StampedPose> estimate, std::size_t matches,
                                       const AssociationOptions& options) {
  const auto span_of = [](std::span<const StampedPose> poses) {
    return poses.empty()
               ? std::string("nothing")
               : fmt::format("{:.6f} to {:.6f} s", poses.front().timestamp, poses.back().timestamp);
  };
  throw Error(fmt::format(
      "{} of the trajectory's {} poses within {} s of a ground truth pose, at least 2 needed: "
      "ground "
      "truth has {}, trajectory has {}, offset {} s; check that the files belong together, or give "
      "the difference of the clocks with --offset",
      matches, estimate.size(), options.max_difference, span_of(truth), span_of(estimate),
      options.offset));
}

}  // namespace

AbsoluteError absolute_error(std::span<const StampedPose> truth,
                             std::span<const StampedPose> estimate,
                             const AssociationOptions& options) {
  AbsoluteError result;
  result.matches = associate(truth, estimate, options);
  if (result.matches.size() < 2) {
    fail_without_overlap(truth, estimate, result.matches.size(), options);
  }
  const auto count = static_cast<Eigen::Index>(result.matches.size());
  Points truth_points(3, count);
  Points estimate_points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const PoseMatch& match = result.matches[static_cast<std::size_t>(i)];
    truth_points.col(i) = truth[match.truth].world_from_camera.translation;
    estimate_points.col(i) = estimate[match.estimate].world_from_camera.translation;
  }
  result.truth_from_estimate = align(estimate_points, truth_points);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d aligned = result.truth_from_estimate * estimate_points.col(i).eval();
    result.errors.push_back((aligned - truth_points.col(i)).norm());
  }
  result.statistics = summarise(result.errors);
  return result;
}

}  // namespace dkp_slam

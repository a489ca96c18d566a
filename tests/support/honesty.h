#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam::testing {

/// One pose as told at the time.
struct FrameHonesty {
  int index = 0;
  double error = 0.0;       ///< of the position, metres
  double sigma = 0.0;       ///< told, in the worst direction, metres
  double sigmas_off = 0.0;  ///< in position or orientation, whichever is more
};

/// What the poses as told at the time are off, and what they said they might be.
struct Honesty {
  int localised = 0;
  int over_three_sigma = 0;                        ///< in position or orientation
  double worst = 0.0;                              ///< in standard deviations
  double median_error = 0.0, largest_error = 0.0;  ///< of the position, metres
  double median_sigma = 0.0;                       ///< told, in the worst direction, metres
  std::vector<FrameHonesty> frames;                ///< those that were localised
};

inline const StampedPose& at(const Trajectory& truth, double timestamp) {
  return *std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.timestamp - timestamp) < std::abs(b.timestamp - timestamp);
  });
}

/// The frames' world laid over the true one, by their orientations (a short path's places tell
/// little of the turn) and the middle of their places; each frame by how sure it says it is.
inline Se3 truth_from_world(const std::vector<FrameResult>& localised, const Trajectory& truth) {
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  Eigen::Vector3d there = Eigen::Vector3d::Zero(), here = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (const FrameResult& f : localised) {
    const Se3& right = at(truth, f.timestamp).world_from_camera;
    const Eigen::Matrix3d turn = f.quality.covariance.block<3, 3>(3, 3);
    const double weight = std::pow(f.quality.position_sigma(), -2);
    turns += (right.rotation * f.world_from_camera.rotation.conjugate()).toRotationMatrix() /
             turn.trace();
    there += weight * right.translation;
    here += weight * f.world_from_camera.translation;
    weights += weight;
  }
  there /= weights;
  here /= weights;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turns, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Quaterniond turn(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  return {turn, there - turn * here};
}

inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of the frames that were localised, all in one map; there must be some.
inline Honesty honesty_of(const std::vector<FrameResult>& frames, const Trajectory& truth) {
  std::vector<FrameResult> localised;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(localised),
               [](const FrameResult& f) { return f.localised; });
  const Se3 alignment = truth_from_world(localised, truth);
  Honesty honesty;
  honesty.localised = static_cast<int>(localised.size());
  std::vector<double> errors, sigmas;
  for (const FrameResult& f : localised) {
    const Vector6d off =
        ((alignment * f.world_from_camera).inverse() * at(truth, f.timestamp).world_from_camera)
            .log();
    const auto distance = [&](int part) {
      const Eigen::Matrix3d covariance = f.quality.covariance.block<3, 3>(part, part);
      const Eigen::Vector3d error = off.segment<3>(part);
      return std::sqrt(error.dot(covariance.ldlt().solve(error)));
    };
    const double sigmas_off = std::max(distance(0), distance(3));
    honesty.over_three_sigma += sigmas_off > 3.0;
    honesty.worst = std::max(honesty.worst, sigmas_off);
    errors.push_back(off.head<3>().norm());
    sigmas.push_back(f.quality.position_sigma());
    honesty.frames.push_back({f.index, errors.back(), sigmas.back(), sigmas_off});
  }
  honesty.median_error = median_of(errors);
  honesty.largest_error = *std::max_element(errors.begin(), errors.end());
  honesty.median_sigma = median_of(sigmas);
  return honesty;
}

}  // namespace dkp_slam::testing

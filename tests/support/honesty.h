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
  double error = 0.0;         ///< of the position, metres
  double turn_error = 0.0;    ///< of the orientation, radians
  double sigma = 0.0;         ///< told of the position, in the worst direction, metres
  double position_off = 0.0;  ///< in standard deviations
  double orientation_off = 0.0;

  /// In position or orientation, whichever is more.
  double sigmas_off() const { return std::max(position_off, orientation_off); }
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

/// In between, straight from pose to pose; before the first and after the last as these.
inline Se3 pose_at(const Trajectory& truth, double timestamp) {
  const auto after =
      std::upper_bound(truth.begin(), truth.end(), timestamp,
                       [](double t, const StampedPose& pose) { return t < pose.timestamp; });
  if (after == truth.begin()) return truth.front().world_from_camera;
  const StampedPose& a = *std::prev(after);
  if (after == truth.end()) return a.world_from_camera;
  const double share = (timestamp - a.timestamp) / (after->timestamp - a.timestamp);
  const Vector6d way = (a.world_from_camera.inverse() * after->world_from_camera).log();
  return a.world_from_camera * Se3::exp(share * way);
}

inline std::vector<FrameResult> localised_of(const std::vector<FrameResult>& frames) {
  std::vector<FrameResult> localised;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(localised),
               [](const FrameResult& f) { return f.localised; });
  return localised;
}

/// The frames' world laid over the true one, by their orientations (a short path's places tell
/// little of the turn) and the middle of their places; each frame by how sure it says it is.
inline Se3 truth_from_world(const std::vector<FrameResult>& localised, const Trajectory& truth) {
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  Eigen::Vector3d there = Eigen::Vector3d::Zero(), here = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (const FrameResult& f : localised) {
    const Se3 right = pose_at(truth, f.timestamp);
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
  const std::vector<FrameResult> localised = localised_of(frames);
  const Se3 alignment = truth_from_world(localised, truth);
  Honesty honesty;
  honesty.localised = static_cast<int>(localised.size());
  std::vector<double> errors, sigmas;
  for (const FrameResult& f : localised) {
    const Vector6d off =
        ((alignment * f.world_from_camera).inverse() * pose_at(truth, f.timestamp)).log();
    const auto distance = [&](int part) {
      const Eigen::Matrix3d covariance = f.quality.covariance.block<3, 3>(part, part);
      const Eigen::Vector3d error = off.segment<3>(part);
      return std::sqrt(error.dot(covariance.ldlt().solve(error)));
    };
    errors.push_back(off.head<3>().norm());
    sigmas.push_back(f.quality.position_sigma());
    const FrameHonesty& frame = honesty.frames.emplace_back(FrameHonesty{
        f.index, errors.back(), off.tail<3>().norm(), sigmas.back(), distance(0), distance(3)});
    honesty.over_three_sigma += frame.sigmas_off() > 3.0;
    honesty.worst = std::max(honesty.worst, frame.sigmas_off());
  }
  honesty.median_error = median_of(errors);
  honesty.largest_error = *std::max_element(errors.begin(), errors.end());
  honesty.median_sigma = median_of(sigmas);
  return honesty;
}

}  // namespace dkp_slam::testing

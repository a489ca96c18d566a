#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {

class OptionList;

struct AlignmentOptions {
  /// Samples at most: enough to meet three good ones out of matches of which four in five are
  /// wrong, with 99.9%. Most wrong samples cost next to nothing: their sides do not fit.
  int samples = 1000;
  double confidence = 0.999;  ///< that a good sample was met; then no more are drawn
  /// Pixels on level 0 of an image 640 wide (see SensorScale). A pose from three points is as wrong
  /// as their depths are: 2 cm at 1.5 m are 7 px.
  double pixel_bound = 10.0;
  double least_side = 0.05;  ///< metres, of the triangle that three points make
  int least_inliers = 10;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A rigid motion and the observations that agree with it.
struct Alignment {
  Se3 camera_from_world;
  std::vector<char> inlier;  ///< one per observation
  int inliers = 0;
};

/// Camera's pose from matches many of which are wrong, without a guess: RANSAC (Fischler and Bolles
/// 1981) over triples of points with depth in both, aligned in least squares (Umeyama 1991, without
/// scale), counted by reprojection error; the best is fitted anew to all its inliers. Observations
/// without depth cannot be drawn, but count. Same seed, same result. Nothing when fewer than
/// `least_inliers` agree.
std::optional<Alignment> align_camera(const Camera& camera, const MeasurementModel& model,
                                      std::span<const PoseObservation> observations,
                                      const AlignmentOptions& options = {}, std::uint64_t seed = 1);

}  // namespace dkp_slam

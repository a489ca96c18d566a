#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

struct PathSmootherOptions {
  bool smooth = true;
  /// How far a tracked pose is off by itself, beside what it shares with its neighbours, sigma per
  /// axis, metres and radians.
  double pose_translation = 0.003;
  double pose_rotation = 0.003;
  /// How far a motion from frame to frame is off that was measured by flow.
  double motion_translation = 0.002;
  double motion_rotation = 0.002;
  /// Sigmas from which on a pose or a motion counts less and less: somebody filled the view, or
  /// the frame was carried.
  double doubtful = 3.0;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A pose of a path.
struct PathPose {
  Se3 camera_from_world;
  std::optional<Se3> from_previous;  ///< this camera from the camera at the pose before, measured
  int landmarks = 0;                 ///< that the pose rests on
};

/// The path that agrees best with both the tracked poses and the motions between them, in robust
/// least squares on SE(3) (a chain, solved by block elimination). Poses come from landmarks, each
/// frame by itself, so that they jitter about the path; motions come from flow, which follows the
/// pixels themselves, but drifts. Time and memory grow with the length of the path alone.
void smooth_path(std::vector<PathPose>& path, const PathSmootherOptions& options);

}  // namespace dkp_slam

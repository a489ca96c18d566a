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
  /// How the camera's velocity changes: as by an acceleration drawn anew 30 times a second, sigma
  /// per axis, m/s^2 and rad/s^2. Hands that were measured by motion capture have 0.3 to 0.6 m/s^2.
  double acceleration = 0.7;
  double angular_acceleration = 10.0;
  /// Sigmas from which on a pose, a motion or a change of velocity counts less and less: somebody
  /// filled the view, the frame was carried, or the camera was knocked against something.
  double doubtful = 3.0;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A pose of a path.
struct PathPose {
  double timestamp = 0.0;  ///< seconds
  Se3 camera_from_world;
  std::optional<Se3> from_previous;  ///< this camera from the camera at the pose before, measured
  int landmarks = 0;                 ///< that the pose rests on
  bool continues = true;             ///< the camera moved here from the pose before
};

/// The path that agrees best with the tracked poses, with the motions measured between them, and
/// with a camera that has mass, in robust least squares on SE(3) (a chain of poses and velocities,
/// solved by block elimination). Poses come from landmarks, each frame by itself, so that they
/// jitter about the path; motions come from flow, which follows the pixels themselves, but drifts;
/// and between poses velocity is a Wiener process (the prior "white noise on acceleration" of
/// Anderson and Barfoot 2015, "Full STEAM Ahead: Exactly Sparse Gaussian Process Regression for
/// Batch Continuous-Time Trajectory Estimation on SE(3)"). Stamps rise. Time and memory grow with
/// the length of the path alone.
void smooth_path(std::vector<PathPose>& path, const PathSmootherOptions& options);

}  // namespace dkp_slam

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// Pose world_from_camera at a time, seconds from 0. Smooth, and the same at every call.
using CameraPath = std::function<Se3(double time)>;

/// Camera motions after those of the TUM benchmark's freiburg3 sequences.
enum class SyntheticMotion {
  xyz,         ///< along all three axes, looking ahead
  slow_xyz,    ///< the same at half the speed
  rpy,         ///< turned about all three axes, almost in one place
  halfsphere,  ///< on a part of a sphere around the desk, looking at it
  still,       ///< held by hand in one place: moves by a centimetre
};

/// Where a motion is in the office: about what it moves and which way it looks on the average.
struct Standpoint {
  Eigen::Vector3d position{0.0, -1.30, 1.40};  ///< metres; a standing man's chest, before the desk
  double heading = 0.0;                        ///< radians from +y towards -x
  double pitch = -0.15;                        ///< radians, up is positive: at the desk's things
};

/// Camera axes (x right, y down, z ahead) of a view: radians, heading from +y towards -x, pitch up,
/// roll right side up.
Eigen::Quaterniond camera_view(double heading, double pitch, double roll);

/// How far a motion has come that starts at rest and is at full speed after a second, in seconds of
/// its full speed.
double from_rest(double time);

/// A hand-held camera before the desk. Speeds and frequencies are those of the recordings; the seed
/// changes everything else. It starts at rest and picks up speed within a second.
CameraPath hand_motion(SyntheticMotion motion, std::uint64_t seed, const Standpoint& at = {});

/// Somebody walks along a closed line of way points (x, y; metres), over and over, looks ahead, and
/// holds the camera before his chest, which sways with his steps. Corners are rounded.
CameraPath walking_motion(const std::vector<Eigen::Vector2d>& way_points, std::uint64_t seed);
/// Length of the rounded line, metres.
double walking_length(const std::vector<Eigen::Vector2d>& way_points);
constexpr double camera_walking_speed = 0.6;  ///< metres per second

/// A recorded path, made smooth.
struct RecordedMotion {
  CameraPath motion;
  double duration = 0.0;  ///< seconds
};

/// The camera path of a file in TUM format (z up; a benchmark's ground truth), put into the office
/// as a whole so that its mean place, height and heading are those of `at`. The jitter of motion
/// capture is smoothed, gaps are bridged. Throws `Error` naming the file, and the line where there
/// is one: unreadable, under a second long, poses more than a second apart on the average, z not
/// up, or too wide for the office.
RecordedMotion recorded_motion(const std::filesystem::path& file, const Standpoint& at = {});
/// The same of poses read already; `name` is for messages.
RecordedMotion recorded_motion(const Trajectory& poses, const std::string& name,
                               const Standpoint& at = {});

}  // namespace dkp_slam

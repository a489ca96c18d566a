#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// Reads a trajectory in the TUM RGB-D benchmark's format: one pose a line, `timestamp tx ty tz qx
/// qy qz qw` (seconds, metres, world_from_camera), separated by blanks, tabs or commas; lines that
/// start with '#' are comments. Quaternions are normalised. Lines out of order are sorted, and of
/// several lines with one time stamp the last one counts, as in the benchmark's own tools; both are
/// logged as warnings. Throws `Error` with file and line for anything else: not eight fields, not a
/// number, NaN or infinite, a quaternion of zeros, no pose at all.
Trajectory read_trajectory(const std::filesystem::path& path);

/// A line of the same format, with its end: microseconds, 7 digits of translation, 9 of rotation,
/// qw not negative, so that the same pose gives the same bytes. Throws `Error` when it is not
/// finite.
std::string trajectory_line(const StampedPose& pose);

/// Writes a file of such lines, atomically. Throws `Error` when the file cannot be written or a
/// pose is not finite; an earlier file is then still there.
void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

}  // namespace dkp_slam

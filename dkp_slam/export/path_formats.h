#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

/// How other programs want a camera's path (docs/export.md).
enum class PathFormat { tum, kitti, euroc, ply, gltf };

struct PathFormatInfo {
  PathFormat format;
  const char* name;    ///< of an option
  const char* ending;  ///< of a file, with its dot
};
const std::vector<PathFormatInfo>& path_formats();

/// Poses as such a file's content. All but glTF in the axes of the poses, world from camera,
/// metres.
///
/// kitti: the 3 x 4 matrix of a pose a line, row by row; no time stamps. euroc: CSV of nanoseconds,
/// position and quaternion (w first). ply: positions as vertices and the way between them as
/// edges. glTF: a line strip in one file, turned to its axes (y up, z towards the viewer) as if the
/// first camera was held upright.
///
/// Throws `Error` for a pose that is not finite, and for no pose at all.
std::string path_text(PathFormat format, std::span<const StampedPose> poses);

/// Writes a file of `path_text`, whole or not at all. Throws `Error`.
void write_path(PathFormat format, const std::filesystem::path& file,
                std::span<const StampedPose> poses);

}  // namespace dkp_slam

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Four rows of four numbers between blanks, as in the pose and intrinsics files of 7-Scenes and
/// ScanNet; "inf" and "nan" are numbers, too. `name` stands for the file in messages. Throws
/// `Error` for anything else.
Eigen::Matrix4d parse_matrix(const std::string& text, const std::string& name);

/// The same of a file. Throws `Error`, which names it.
Eigen::Matrix4d read_matrix(const std::filesystem::path& file);

/// A pose of such a matrix, metres; nothing where one of its numbers is not finite. Throws `Error`
/// where it is no rotation with a translation.
std::optional<Se3> pose_of_matrix(const Eigen::Matrix4d& matrix, const std::string& name);

/// Focal lengths and principal point of a matrix with them, pixels.
struct Intrinsics {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
};

/// Throws `Error` where the matrix is not one of a camera without skew.
Intrinsics intrinsics_of_matrix(const Eigen::Matrix4d& matrix, const std::string& name);

}  // namespace dkp_slam

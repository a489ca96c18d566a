#include "dkp_slam/sensor/layout/pose_text.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <Eigen/LU>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam {
namespace {

bool has_last_row(const Eigen::Matrix4d& matrix) {
  constexpr double same = 1e-6;
  return (matrix.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).cwiseAbs().maxCoeff() < same;
}

}  // namespace

Eigen::Matrix4d parse_matrix(const std::string& text, const std::string& name) {
  constexpr int count = 16;
  Eigen::Matrix4d matrix;
  std::istringstream stream(text);
  int read = 0;
  for (std::string word; stream >> word; ++read) {
    if (read == count) throw Error(name + ": has more than the 16 numbers of a 4 x 4 matrix");
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw Error(fmt::format("{}: \"{}\" is no number; expected four rows of four", name,
                              word.substr(0, 20)));
    }
    matrix(read / 4, read % 4) = value;
  }
  if (read != count) {
    throw Error(fmt::format("{}: has {} numbers, not the 16 of a 4 x 4 matrix", name, read));
  }
  return matrix;
}

Eigen::Matrix4d read_matrix(const std::filesystem::path& file) {
  constexpr std::uintmax_t most = 10'000;
  std::ifstream stream =
      open_text(file, most, "cannot be read", "check that it is there and may be read");
  return parse_matrix({std::istreambuf_iterator<char>(stream), {}}, file.string());
}

std::optional<Se3> pose_of_matrix(const Eigen::Matrix4d& matrix, const std::string& name) {
  if (!matrix.allFinite()) return std::nullopt;
  if (!has_last_row(matrix)) throw Error(name + ": is no pose: its last row must be 0 0 0 1");
  const Eigen::Matrix3d r = matrix.topLeftCorner<3, 3>();
  constexpr double rounding = 0.01;  // the files have three digits at least
  // The first bound keeps the products finite.
  if (r.cwiseAbs().maxCoeff() > 1.0 + rounding || r.determinant() < 0.0 ||
      (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > rounding) {
    throw Error(name + ": is no pose: its first three columns are no rotation");
  }
  return Se3{Eigen::Quaterniond(r).normalized(), matrix.topRightCorner<3, 1>()};
}

Intrinsics intrinsics_of_matrix(const Eigen::Matrix4d& matrix, const std::string& name) {
  const Intrinsics found{matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2)};
  Eigen::Matrix4d pinhole = Eigen::Matrix4d::Identity();
  pinhole(0, 0) = found.fx;
  pinhole(1, 1) = found.fy;
  pinhole(0, 2) = found.cx;
  pinhole(1, 2) = found.cy;
  constexpr double same = 1e-6;
  if (!matrix.allFinite() || !((matrix - pinhole).cwiseAbs().maxCoeff() < same) ||
      !(found.fx > 0.0) || !(found.fy > 0.0)) {
    throw Error(name +
                ": are no intrinsics of a pinhole camera; expected fx 0 cx 0, 0 fy cy 0, "
                "0 0 1 0, 0 0 0 1");
  }
  return found;
}

}  // namespace dkp_slam

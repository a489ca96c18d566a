#pragma once

#include <string>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam::python {

namespace py = pybind11;

/// `object` as a numpy array. Throws TypeError, which calls it by `name`, for anything else.
py::array array_named(const char* name, const py::object& object);

/// "float64 of shape (480, 640)", for messages.
std::string text_of(const py::array& array);

/// An image over the array's memory, of which it keeps a reference until the last copy of the
/// image is gone, in whatever thread. Pixels must lie side by side in a row, rows may be further
/// apart. Throws ValueError, which says what to do, unless type and shape are `type`'s.
/// `expected`: how such an array is described, as "uint8 of shape (height, width, 3)".
cv::Mat borrow(const char* name, const py::array& array, int type, const char* expected);

/// The image's pixels as an array that keeps them alive: 8 or 16 bits or float, no copy. Cannot be
/// written to, unless `writeable`.
py::array array_of(const cv::Mat& image, bool writeable = false);

/// 4 x 4, float64.
py::array_t<double> matrix_of(const Se3& pose);
/// Throws ValueError, which calls it by `name`, where it is no rigid motion.
Se3 pose_of(const std::string& name, const py::object& matrix);

/// dkp_slam.Trajectory: time stamps of shape (n,) and poses of shape (n, 4, 4).
py::object trajectory_object(const Trajectory& trajectory);
/// From a dkp_slam.Trajectory or any two such arrays, or from a file in TUM format where it is a
/// path. Throws ValueError, which calls it by `name`, for stamps that do not rise, shapes that do
/// not fit, numbers that are not finite and poses that are no rigid motions.
Trajectory trajectory_of(const char* name, const py::object& object);

/// The exceptions that Python knows, with a text made by fmt.
[[noreturn]] void value_error(const std::string& text);

}  // namespace dkp_slam::python

#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace dkp_slam::python {

/// "ZeroDivisionError: division by zero (room.py:12)", in one line. With the GIL held.
std::string line_of(const pybind11::error_already_set& error);

}  // namespace dkp_slam::python

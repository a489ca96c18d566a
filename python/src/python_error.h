#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace dkp_slam::python {

/// What Python's str() makes of an object. With the GIL held.
std::string plain_text(const pybind11::object& object);
/// "ZeroDivisionError: division by zero (room.py:12)", in one line. With the GIL held.
std::string line_of(const pybind11::error_already_set& error);

}  // namespace dkp_slam::python

#pragma once

#include <pybind11/pybind11.h>

namespace dkp_slam::python {

// What the module `_core` holds, a source file each.
void bind_camera(pybind11::module_& module);
void bind_config(pybind11::module_& module);
void bind_dense(pybind11::module_& module);
void bind_detection(pybind11::module_& module);
void bind_frames(pybind11::module_& module);
void bind_evaluation(pybind11::module_& module);
void bind_map(pybind11::module_& module);
void bind_result(pybind11::module_& module);
void bind_slam(pybind11::module_& module);

}  // namespace dkp_slam::python

#include <pybind11/pybind11.h>

#include "dkp_slam/error.h"
#include "dkp_slam/version.h"
#include "python/src/bindings.h"
#include "python/src/mailbox.h"

PYBIND11_MODULE(_core, module) {
  using namespace dkp_slam::python;
  module.doc() = "The system behind dkp_slam; use it through the package.";
  module.attr("__version__") = DKP_SLAM_VERSION;
  pybind11::register_exception<dkp_slam::Error>(module, "Error", PyExc_RuntimeError).doc() =
      "What the system cannot do: one line that says what is wrong, where, and what to do about "
      "it.";
  log_to_python();
  bind_camera(module);
  bind_config(module);
  bind_detection(module);
  bind_frames(module);
  bind_evaluation(module);
  bind_map(module);
  bind_dense(module);
  bind_slam(module);
}

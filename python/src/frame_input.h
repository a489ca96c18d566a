#pragma once

#include "python/src/arrays.h"
#include "python/src/session.h"

namespace dkp_slam::python {

/// How images come in from Python.
struct FrameInput {
  py::object rgb, depth, mask;
  double timestamp = 0.0;
  std::string order;  ///< "rgb" or "bgr"
  std::optional<double> depth_scale;
  double depth_delay = 0.0;
  bool copy = false;
};

/// As a frame of a camera, with whatever mask and time stamp it has. Throws TypeError and
/// ValueError, which say which input is wrong and what to do.
RgbdFrame frame_of(const FrameInput& input, const Camera& camera);

/// As the next frame of a session. Throws the same, also for a time stamp that does
/// not rise and a mask that the mode does not use.
RgbdFrame frame_of(const FrameInput& input, const Session& session);

}  // namespace dkp_slam::python

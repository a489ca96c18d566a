#pragma once

#include <string>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// What a camera file says of the depth images beside their scale: `open_tum_folder` applies it.
struct DepthCorrection {
  /// Seconds by which the light of a depth image came later than its time stamp says, compared with
  /// the colour images' stamps; negative when it came earlier.
  double delay = 0.0;
  /// Metres to be added to every known depth once it is in metres.
  double bias = 0.0;
};

/// Reads a camera file (YAML; config/tum_fr1.yaml explains every key). width, height, fx, fy, cx,
/// cy and depth_scale have no default and must be there. Throws `Error` ("FILE:LINE: field: what,
/// remedy") when the file cannot be read, is no YAML, lacks a field, holds an unknown or repeated
/// one, a value of the wrong type, NaN, or parameters that make no camera.
Camera load_camera(const std::string& path);

/// The same of such a file's text; `name` stands for the file in messages.
Camera parse_camera(const std::string& text, const std::string& name);

/// The keys depth_delay and depth_bias of a camera file, 0 where they are missing. Checks and
/// throws as `load_camera` does.
DepthCorrection load_depth_correction(const std::string& path);

/// A camera file's text, which the two functions above read back exactly.
std::string camera_text(const Camera& camera, const DepthCorrection& depth = {});

/// Writes that text. Throws `Error`.
void save_camera(const Camera& camera, const std::string& path, const DepthCorrection& depth = {});

}  // namespace dkp_slam

#pragma once

#include <string>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// Reads a camera file (YAML; config/tum_fr1.yaml explains every key). width, height, fx, fy, cx,
/// cy and depth_scale have no default and must be there. Throws `Error` ("FILE:LINE: field: what,
/// remedy") when the file cannot be read, is no YAML, lacks a field, holds an unknown or repeated
/// one, a value of the wrong type, NaN, or parameters that make no camera.
Camera load_camera(const std::string& path);

/// The same of such a file's text; `name` stands for the file in messages.
Camera parse_camera(const std::string& text, const std::string& name);

/// A camera file's text, which the two functions above read back exactly.
std::string camera_text(const Camera& camera);

/// Writes that text. Throws `Error`.
void save_camera(const Camera& camera, const std::string& path);

}  // namespace dkp_slam

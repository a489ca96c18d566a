#pragma once

#include <filesystem>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam::python {

/// Of a sequence: its camera.yaml, else what the folder's name tells. Throws `Error`.
Camera camera_of_folder(const std::filesystem::path& folder);

}  // namespace dkp_slam::python

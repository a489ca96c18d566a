#pragma once

#include <filesystem>
#include <string>

namespace dkp_slam::apps {

/// Camera file of a sequence: `wanted`, which is a file or one of fr1, fr2, fr3 and bonn; where it
/// is empty FOLDER/camera.yaml, else the one of the program's own that the folder's name tells
/// (that of a benchmark: rgbd_dataset_freiburg3_..., rgbd_bonn_...). Throws `Error` where there is
/// none.
std::filesystem::path choose_camera(const std::filesystem::path& folder, const std::string& wanted);

}  // namespace dkp_slam::apps

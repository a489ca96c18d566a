#pragma once

#include <filesystem>
#include <string>

namespace dkp_slam::apps {

/// What `--camera` takes beside a file, for help and messages.
inline constexpr const char* camera_names = "fr1, fr2, fr3, bonn, icl, 7scenes, kinect";

/// Camera file of a sequence: `wanted`, which is a file or one of `camera_names`; where it is empty
/// FOLDER/camera.yaml, else the one of the program's own that the layout tells (published_camera)
/// or the folder's name (that of a benchmark: rgbd_dataset_freiburg3_..., rgbd_bonn_...). Throws
/// `Error` where there is none.
std::filesystem::path choose_camera(const std::filesystem::path& folder, const std::string& wanted);

}  // namespace dkp_slam::apps

#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/layout/image_folder.h"

namespace dkp_slam::apps {

/// The true path that a folder of images brings: what its layout says (layout_truth), else its
/// groundtruth.txt. Empty where there is none, and for what is no folder. Throws `Error` where it
/// is malformed.
Trajectory true_path(const std::filesystem::path& sequence, double frame_rate = usual_frame_rate);

}  // namespace dkp_slam::apps

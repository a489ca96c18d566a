#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/sensor/tum_source.h"

namespace dkp_slam {

/// Images a second of a layout that brings no time stamps: image N is at N / rate seconds.
constexpr double usual_frame_rate = 30.0;

/// How images lie in a folder (docs/sources.md).
enum class FolderLayout {
  tum,           ///< rgb.txt and depth.txt, or associations.txt: TUM and Bonn
  icl_nuim,      ///< rgb/N.png, depth/N.png
  seven_scenes,  ///< frame-N.color.png, frame-N.depth.png, frame-N.pose.txt
  scannet,       ///< color/N.jpg, depth/N.png, pose/N.txt, intrinsic/
};

/// As a user knows it: "ICL-NUIM".
const char* layout_name(FolderLayout layout);

/// Told by what lies in the folder; tum where nothing else fits, also for a folder that is missing.
FolderLayout layout_of(const std::filesystem::path& folder);

/// The camera that the folder itself describes: of ScanNet's intrinsics, with the size of its depth
/// images. Nothing for the other layouts. Throws `Error` where a file is missing or malformed.
std::optional<Camera> own_camera(const std::filesystem::path& folder);

/// Name of the camera file of config/ that such a dataset's images are of; empty for the other
/// layouts, and where numbered images need not be ICL-NUIM's: neither its associations.txt nor its
/// *.gt.freiburg lies there.
std::string published_camera(const std::filesystem::path& folder);

/// Opens a folder of any layout. `camera` is that of the frames that come out, `frame_rate` (Hz)
/// that of a layout without time stamps.
///
/// 7-Scenes: depth is registered to colour with the depth camera that the dataset publishes and a
/// Kinect's usual distance between the cameras. ScanNet: colour is resampled into the pixels of
/// depth by both intrinsics. Numbers are in the order of their values; an image whose partner is
/// missing is left out, a gap in the numbers is one in time. Throws and skips as `open_tum_folder`
/// does.
std::unique_ptr<RgbdSource> open_image_folder(const std::string& folder, const Camera& camera,
                                              const TumOptions& options = {},
                                              double frame_rate = usual_frame_rate);

/// The true path that these layouts bring, of the colour camera, x right, y down, z forward: that
/// of 7-Scenes and ScanNet by the pose files (what is not finite is unknown), of ICL-NUIM by
/// *.gt.freiburg in the folder, or a groundtruth.txt whose stamps count images, too, mirrored as
/// its axes are. Empty where there is none, and for TUM. Throws `Error`, which names the file.
Trajectory layout_truth(const std::filesystem::path& folder, double frame_rate = usual_frame_rate);

}  // namespace dkp_slam

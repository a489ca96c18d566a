#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/folder_source.h"
#include "dkp_slam/sensor/tum_lists.h"

namespace dkp_slam {

/// One layout other than TUM's. What it reads it throws `Error` about, naming the file.
class ImageLayout {
 public:
  virtual ~ImageLayout() = default;
  /// Whether the folder has what tells this layout.
  virtual bool fits(const std::filesystem::path& folder) const = 0;
  /// Stamps in seconds from 0 on, by the images' numbers; paths relative to the folder.
  virtual std::vector<ImagePair> pairs(const std::filesystem::path& folder, double rate) const = 0;
  /// Null where images are what a frame is.
  virtual std::unique_ptr<ImageFit> fit(const std::filesystem::path& folder,
                                        const Camera& camera) const = 0;
  virtual std::optional<Camera> own_camera(const std::filesystem::path& folder) const = 0;
  /// Name of the camera file that the dataset's authors stand for; empty where the folder may be
  /// anybody's.
  virtual std::string camera_file(const std::filesystem::path& folder) const = 0;
  virtual Trajectory truth(const std::filesystem::path& folder, double rate) const = 0;
};

/// ICL-NUIM's lines "N tx ty tz qx qy qz qw", N at N / `rate` seconds, y mirrored in camera and
/// world (layout_truth). Throws `Error` with file and line.
Trajectory read_icl_truth(const std::filesystem::path& file, double rate);

std::unique_ptr<ImageLayout> icl_nuim_layout();
std::unique_ptr<ImageLayout> seven_scenes_layout();
std::unique_ptr<ImageLayout> scannet_layout();

}  // namespace dkp_slam

#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam {

/// A folder with somebody's segmentation: for a colour image rgb/STEM.png or .jpg the mask STEM.png
/// (RgbdFrame::mask).
class MaskFolder {
 public:
  /// Throws `Error` when there is no such folder, or no mask in it for any of these colour images.
  MaskFolder(std::filesystem::path folder, const std::vector<std::string>& colour_files);

  /// Mask of a colour image of this size; empty, with a warning the first time, when there is no
  /// such file. Throws `Error`, which names the file, for one of another type or size and for a
  /// damaged one: to go on as if it were missing would be a result with other masks than were
  /// given.
  cv::Mat read(const std::string& colour_file, const cv::Size& size);
  /// Throws as `read`, and says and counts nothing where there is no mask.
  void check(const std::string& colour_file, const cv::Size& size);

  /// Masks that `read` did not find.
  std::size_t missing() const { return missing_; }

 private:
  std::filesystem::path file_of(const std::string& colour_file) const;
  cv::Mat load(const std::filesystem::path& file, const cv::Size& size);

  std::filesystem::path folder_;
  ImageReader reader_;
  std::size_t missing_ = 0;
};

}  // namespace dkp_slam

#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/jpeg_codec.h"

// Image files by the program's own code, which image_files_test holds against OpenCV's. With
// imgcodecs and the 100 libraries behind it every test takes 0.2 s longer to start.
namespace dkp_slam::testing {

/// A JPEG file where the name says so, else a PNG file.
inline void write_image_as_named(const std::filesystem::path& file, const cv::Mat& image) {
  if (file.extension() != ".jpg") return write_image(file, image);
  const std::vector<std::uint8_t> bytes = encode_jpeg(image, 95);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// As stored; empty where there is no image.
inline cv::Mat read_image(const std::filesystem::path& file) {
  return ImageReader().read_unchanged(file.string()).image;
}

/// The same of a file's bytes.
inline cv::Mat image_of(std::span<const std::uint8_t> bytes) {
  return ImageReader().unchanged_of(bytes).image;
}

}  // namespace dkp_slam::testing

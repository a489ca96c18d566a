#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/png_decoder.h"

namespace dkp_slam {

/// What became of an image file: the image, or a short reason why there is none.
struct ImageRead {
  cv::Mat image;  ///< empty when it could not be read
  std::string problem;
};

/// Reads PNG and JPEG files: PNG by `PngDecoder`, what that leaves by libpng, JPEG by
/// libjpeg-turbo. Not by OpenCV's imgcodecs: it brings 120 libraries that take 80 ms to load. Never
/// throws on bad files. One object per thread.
class ImageReader {
 public:
  static constexpr std::uint64_t usual_most_pixels = 64'000'000;

  /// Of a PNG or JPEG file with more than `most_pixels` only the header is looked at: a small file
  /// may hold an image of gigabytes.
  explicit ImageReader(std::uint64_t most_pixels = usual_most_pixels)
      : most_pixels_(most_pixels), png_(most_pixels) {}
  /// CV_8UC3, BGR. Grey images, images with an alpha channel and 16-bit images are converted.
  ImageRead read_colour(const std::string& path);
  /// Grey as stored, 8 or 16 bits, colour as CV_8UC3; of a depth image the caller checks the type.
  ImageRead read_unchanged(const std::string& path);
  /// The same of a file's bytes.
  ImageRead unchanged_of(std::span<const std::uint8_t> file);
  /// CV_8UC1. Only PNG files of 8-bit grey values: converted from anything else (a palette, a JPEG)
  /// 0 would no longer mean 0.
  ImageRead read_grey_png(const std::string& path);

 private:
  ImageRead decode();

  const std::uint64_t most_pixels_;
  PngDecoder png_;
  std::vector<std::uint8_t> file_;
};

/// CV_16UC1 sensor units to CV_32FC1 metres; 0 where the reading is unknown or outside
/// [min_depth, max_depth] (metres).
cv::Mat depth_in_metres(const cv::Mat& raw, double units_per_metre, double min_depth,
                        double max_depth);

/// CV_32FC1 metres as they came: what is outside [min_depth, max_depth], or no number, becomes 0.
void keep_depth_range(cv::Mat& metres, double min_depth, double max_depth);

/// The way back: CV_32FC1 metres to CV_16UC1 units, rounded; 0 where 16 bits do not reach.
cv::Mat depth_in_units(const cv::Mat& metres, double units_per_metre);

}  // namespace dkp_slam

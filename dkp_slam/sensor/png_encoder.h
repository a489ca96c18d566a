#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

enum class PngSize : std::uint8_t {
  fast,   ///< libdeflate's fastest: noise would hardly get smaller with more
  small,  ///< for drawings: twice as small, ten times as long
};

/// A PNG file of a CV_8UC1, CV_16UC1 or CV_8UC3 (BGR) image, twice as fast as libpng's fastest:
/// libdeflate's lowest level, and each row as its difference from the one above, which is quick to
/// read, too. Throws `Error` on any other image. Format: W3C "Portable Network Graphics
/// Specification (Second Edition)".
std::vector<std::uint8_t> encode_png(const cv::Mat& image, PngSize size = PngSize::fast);

}  // namespace dkp_slam

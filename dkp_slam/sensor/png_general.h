#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Decodes any PNG by libpng: what `PngDecoder`, which is faster, leaves (palettes, alpha channels,
/// interlaced files, 1 to 4 and 3 x 16 bits). `image` becomes CV_8UC1 or CV_16UC1 for grey files,
/// else CV_8UC3, BGR; an alpha channel is left out. False, with the reason, for a damaged file and,
/// before any memory is taken, for more than `most_pixels`.
bool decode_any_png(std::span<const std::uint8_t> file, std::uint64_t most_pixels, cv::Mat* image,
                    std::string* problem);

}  // namespace dkp_slam

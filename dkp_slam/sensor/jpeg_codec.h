#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// True for bytes that begin as a JPEG file does.
bool is_jpeg(std::span<const std::uint8_t> file);

/// A JPEG file as CV_8UC3, BGR, whatever it says of where its top is: the lens model belongs to the
/// image as stored. False, with the reason in `problem`, for a truncated or damaged one and, before
/// any memory is taken, for more than `most_pixels`.
bool decode_jpeg(std::span<const std::uint8_t> file, std::uint64_t most_pixels, cv::Mat* image,
                 std::string* problem);

/// A JPEG file of a CV_8UC3 (BGR) or CV_8UC1 image, quality 1 to 100. Throws `Error` on others.
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality);

}  // namespace dkp_slam

#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Writes a PNG file (encode_png). Throws `Error` that names it; a part of it may then be there.
void write_image(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace dkp_slam

#include "dkp_slam/sensor/mask_folder.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace fs = std::filesystem;

MaskFolder::MaskFolder(fs::path folder, const std::vector<std::string>& colour_files)
    : folder_(std::move(folder)) {
  if (!fs::is_directory(folder_)) {
    throw Error(folder_.string() + ": no such folder; give the one that holds the masks");
  }
  const bool any = std::any_of(colour_files.begin(), colour_files.end(),
                               [&](const std::string& file) { return fs::exists(file_of(file)); });
  if (!any) {
    throw Error(fmt::format("{}: holds no mask for any of {} colour images; that of {} would be {}",
                            folder_.string(), colour_files.size(), colour_files.front(),
                            file_of(colour_files.front()).filename().string()));
  }
}

fs::path MaskFolder::file_of(const std::string& colour_file) const {
  return folder_ / (fs::path(colour_file).stem().string() + ".png");
}

cv::Mat MaskFolder::read(const std::string& colour_file, const cv::Size& size) {
  const fs::path file = file_of(colour_file);
  if (fs::exists(file)) return load(file, size);
  if (missing_++ == 0) {
    spdlog::warn(
        "{}: no such mask; that of an image before is carried on (further ones missing "
        "are only counted)",
        file.string());
  }
  return {};
}

void MaskFolder::check(const std::string& colour_file, const cv::Size& size) {
  const fs::path file = file_of(colour_file);
  if (fs::exists(file)) load(file, size);
}

cv::Mat MaskFolder::load(const fs::path& file, const cv::Size& size) {
  ImageRead mask = reader_.read_grey_png(file);
  if (mask.image.empty()) {
    throw Error(fmt::format("{}: {}; a mask is a PNG of 8-bit grey values, 0 on what is static",
                            file.string(), mask.problem));
  }
  if (mask.image.size() != size) {
    throw Error(fmt::format("{}: the mask is {} x {} pixels but its colour image {} x {}",
                            file.string(), mask.image.cols, mask.image.rows, size.width,
                            size.height));
  }
  return std::move(mask.image);
}

}  // namespace dkp_slam

#include "apps/run_masks.h"

#include <cstdint>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

/// A time stamp with microseconds and .png: nothing else in the folder is touched.
bool is_mask(const fs::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == ".png" && stem.size() > 7 && stem[stem.size() - 7] == '.' &&
         stem.find_first_not_of("0123456789.") == std::string::npos;
}

Error cannot_prepare(const fs::path& folder, const std::error_code& error) {
  return Error(fmt::format("cannot prepare the folder {}: {}; choose another --out",
                           folder.string(), error.message()));
}

}  // namespace

std::string mask_name(double timestamp) { return fmt::format("{:.6f}.png", timestamp); }

void remove_masks(const fs::path& out) {
  const fs::path folder = out / masks_folder;
  try {
    if (!fs::exists(folder)) return;
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (is_mask(entry.path())) old.push_back(entry.path());
    }
    for (const fs::path& file : old) fs::remove(file);
  } catch (const fs::filesystem_error& error) {
    throw cannot_prepare(folder, error.code());
  }
}

MaskWriter::MaskWriter(const fs::path& out) : folder_(out / masks_folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw cannot_prepare(folder_, error);
  check_writable(folder_ / mask_name(0.0));
  remove_masks(out);
}

void MaskWriter::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  guard([&] {
    const cv::Mat& mask = snapshot->dynamics.mask;
    const std::vector<std::uint8_t> png = encode_png(
        mask.empty() ? cv::Mat(cv::Mat::zeros(snapshot->frame.colour.size(), CV_8UC1)) : mask);
    write_file_atomically(folder_ / mask_name(snapshot->frame.timestamp),
                          {reinterpret_cast<const char*>(png.data()), png.size()});
  });
}

}  // namespace dkp_slam::apps

#include "apps/run_overlay.h"

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/overlay.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

fs::path picture_name(int frame_index) { return fmt::format("frame_{:06}.png", frame_index); }

bool is_picture(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("frame_") && name.size() == picture_name(0).string().size() &&
         name.ends_with(".png");
}

}  // namespace

OverlayWriter::OverlayWriter(const fs::path& out, int every)
    : folder_(out / "overlay"), every_(every) {
  try {
    fs::create_directories(folder_);
    check_writable(folder_ / picture_name(0));
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (is_picture(entry.path())) old.push_back(entry.path());
    }
    for (const fs::path& file : old) fs::remove(file);
  } catch (const fs::filesystem_error& error) {
    throw Error(fmt::format("cannot prepare the folder {}: {}; choose another --out",
                            folder_.string(), error.code().message()));
  }
}

void OverlayWriter::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  if (snapshot->frame.index % every_ != 0) return;
  guard([&] {
    const std::vector<std::uint8_t> png =
        encode_png(draw_overlay(snapshot->frame, snapshot->keypoints, snapshot->dynamics));
    write_file_atomically(folder_ / picture_name(snapshot->frame.index),
                          {reinterpret_cast<const char*>(png.data()), png.size()});
    ++pictures_;
  });
}

}  // namespace dkp_slam::apps

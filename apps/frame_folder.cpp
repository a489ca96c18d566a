#include "apps/frame_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>

#include "apps/append_line.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t memory = 256'000'000;  // bytes of frames that wait for the disk

std::size_t frames_in_memory(const Camera& camera) {
  constexpr std::size_t pixel_bytes = 3 + 4 + 1;
  const std::size_t frame = pixel_bytes * static_cast<std::size_t>(camera.width) *
                            static_cast<std::size_t>(camera.height);
  return std::max(memory / frame, OrderedWork::cores());
}

fs::path prepared(const fs::path& out) {
  std::error_code error;
  if (fs::exists(out, error) && (!fs::is_directory(out, error) || !fs::is_empty(out, error))) {
    throw Error(out.string() + ": is there already and not an empty folder; give another --out");
  }
  for (const char* folder : {"rgb", "depth"}) {
    fs::create_directories(out / folder, error);
    if (error) {
      throw Error(fmt::format("{}: cannot make the folder: {}; give another --out", out.string(),
                              error.message()));
    }
  }
  return out;
}

[[noreturn]] void fail_writing(const fs::path& file) {
  throw Error(fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno)));
}

void append(const FileDescriptor& list, const fs::path& file, const std::string& line) {
  if (!append_line(list.number(), line)) fail_writing(file);
}

FileDescriptor new_list(const fs::path& file, const std::string& first_line) {
  FileDescriptor list(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644));
  if (!list.open()) fail_writing(file);
  if (!first_line.empty()) append(list, file, first_line);
  return list;
}

std::string png(const std::string& stamp) { return stamp + ".png"; }

}  // namespace

FrameFolder::FrameFolder(fs::path out, const Camera& camera)
    : out_(prepared(out)),
      depth_scale_(camera.depth_scale),
      most_waiting_(frames_in_memory(camera)),
      rgb_(new_list(out_ / "rgb.txt", "# timestamp filename\n")),
      depth_(new_list(out_ / "depth.txt", "# timestamp filename\n")),
      associations_(new_list(out_ / "associations.txt", "")) {
  save_camera(camera.of_corrected_images(), out_ / "camera.yaml");
}

bool FrameFolder::add(const RgbdFrame& frame, bool wait) {
  writing_.collect(wait ? most_waiting_ - 1 : writing_.under_way());
  if (writing_.under_way() >= most_waiting_) return false;
  Names names;
  names.colour_stamp = fmt::format("{:.6f}", frame.timestamp);
  names.depth_stamp = fmt::format("{:.6f}", frame.timestamp + frame.depth_delay);
  names.colour = png(names.colour_stamp);
  // By the colour image's stamp, too: two frames may share a depth image's.
  names.depth = png(names.colour_stamp);
  if (!frame.mask.empty()) names.mask = png(names.colour_stamp);
  if (!frame.mask.empty() && !std::exchange(mask_folder_, true)) {
    std::error_code error;
    fs::create_directory(out_ / "mask", error);
  }
  const auto write = [this, names, frame] {
    write_image(out_ / "rgb" / names.colour, frame.colour);
    write_image(out_ / "depth" / names.depth, depth_in_units(frame.depth, depth_scale_));
    if (!names.mask.empty()) write_image(out_ / "mask" / names.mask, frame.mask);
  };
  writing_.add({write, [this, names] { list(names); }, [this, names] { drop(names); }});
  return true;
}

void FrameFolder::finish() { writing_.collect(0); }

void FrameFolder::list(const Names& names) {
  append(rgb_, out_ / "rgb.txt", fmt::format("{} rgb/{}\n", names.colour_stamp, names.colour));
  append(depth_, out_ / "depth.txt", fmt::format("{} depth/{}\n", names.depth_stamp, names.depth));
  // Last: what it names is complete.
  append(associations_, out_ / "associations.txt",
         fmt::format("{} rgb/{} {} depth/{}\n", names.colour_stamp, names.colour, names.depth_stamp,
                     names.depth));
  ++written_;
}

void FrameFolder::drop(const Names& names) const {
  std::error_code ignored;
  fs::remove(out_ / "rgb" / names.colour, ignored);
  fs::remove(out_ / "depth" / names.depth, ignored);
  if (!names.mask.empty()) fs::remove(out_ / "mask" / names.mask, ignored);
}

}  // namespace dkp_slam::apps

#include "dkp_slam/sensor/layout/image_folder.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/folder_source.h"
#include "dkp_slam/sensor/layout/image_layout.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

constexpr std::array other_layouts = {FolderLayout::icl_nuim, FolderLayout::seven_scenes,
                                      FolderLayout::scannet};

/// Null for TUM.
std::unique_ptr<ImageLayout> reader_of(FolderLayout layout) {
  switch (layout) {
    case FolderLayout::icl_nuim:
      return icl_nuim_layout();
    case FolderLayout::seven_scenes:
      return seven_scenes_layout();
    case FolderLayout::scannet:
      return scannet_layout();
    case FolderLayout::tum:
      break;
  }
  return nullptr;
}

void check_rate(double frame_rate) {
  if (!(frame_rate > 0.0 && frame_rate <= 1000.0)) {
    throw Error(
        fmt::format("the frame rate must be above 0 and at most 1000 Hz, not {:g}", frame_rate));
  }
}

}  // namespace

const char* layout_name(FolderLayout layout) {
  switch (layout) {
    case FolderLayout::icl_nuim:
      return "ICL-NUIM";
    case FolderLayout::seven_scenes:
      return "7-Scenes";
    case FolderLayout::scannet:
      return "ScanNet";
    case FolderLayout::tum:
      break;
  }
  return "TUM";
}

FolderLayout layout_of(const fs::path& folder) {
  // Lists with time stamps go before whatever else lies there.
  if (fs::exists(folder / "rgb.txt")) return FolderLayout::tum;
  for (const FolderLayout layout : other_layouts) {
    if (reader_of(layout)->fits(folder)) return layout;
  }
  return FolderLayout::tum;
}

std::optional<Camera> own_camera(const fs::path& folder) {
  const auto reader = reader_of(layout_of(folder));
  return reader ? reader->own_camera(folder) : std::nullopt;
}

std::string published_camera(const fs::path& folder) {
  const auto reader = reader_of(layout_of(folder));
  return reader ? reader->camera_file(folder) : "";
}

std::unique_ptr<RgbdSource> open_image_folder(const std::string& folder, const Camera& camera,
                                              const TumOptions& options, double frame_rate) {
  const FolderLayout layout = layout_of(folder);
  const auto reader = reader_of(layout);
  if (!reader) return open_tum_folder(folder, camera, options);
  check_rate(frame_rate);
  if (const auto reason = camera.check()) throw Error("camera: " + *reason);
  std::vector<ImagePair> pairs = reader->pairs(folder, frame_rate);
  spdlog::info("{}: {} frames in the layout of {}, {:g} a second", folder, pairs.size(),
               layout_name(layout), frame_rate);
  return play_folder({folder, std::move(pairs), reader->fit(folder, camera)}, camera, options);
}

Trajectory layout_truth(const fs::path& folder, double frame_rate) {
  check_rate(frame_rate);
  const auto reader = reader_of(layout_of(folder));
  return reader ? reader->truth(folder, frame_rate) : Trajectory();
}

}  // namespace dkp_slam

#include "dkp_slam/sensor/tum_source.h"

#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/folder_source.h"
#include "dkp_slam/sensor/tum_lists.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

std::vector<ImagePair> pair_by_time(const fs::path& folder, double max_difference) {
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    if (!fs::exists(folder / list)) {
      throw Error(
          fmt::format("{}: no {} in this folder; a TUM or Bonn sequence has rgb.txt and "
                      "depth.txt, or associations.txt (docs/sources.md: other layouts)",
                      folder.string(), list));
    }
  }
  const std::vector<StampedFile> colour = read_stamped_files(folder / "rgb.txt");
  const std::vector<StampedFile> depth = read_stamped_files(folder / "depth.txt");
  const auto stamps = [](const std::vector<StampedFile>& files) {
    std::vector<double> result;
    for (const StampedFile& file : files) result.push_back(file.timestamp);
    return result;
  };
  std::vector<ImagePair> pairs;
  for (const auto& [c, d] : associate(stamps(colour), stamps(depth), max_difference)) {
    pairs.push_back({colour[c].timestamp, colour[c].path, depth[d].path, depth[d].timestamp});
  }
  if (pairs.empty()) {
    throw Error(
        fmt::format("{}: none of {} colour images has one of {} depth images within {} s; "
                    "check rgb.txt and depth.txt",
                    folder.string(), colour.size(), depth.size(), max_difference));
  }
  if (pairs.size() < colour.size()) {
    spdlog::debug("{}: {} of {} colour images have no depth image within {} s", folder.string(),
                  colour.size() - pairs.size(), colour.size(), max_difference);
  }
  return pairs;
}

std::vector<ImagePair> list_pairs(const fs::path& folder, const TumOptions& options) {
  if (!fs::exists(folder)) throw Error(folder.string() + ": no such folder; check the path");
  if (!fs::is_directory(folder)) {
    throw Error(folder.string() + ": is no folder; give the folder that holds rgb.txt");
  }
  if (!(options.max_difference > 0.0)) throw Error("max_difference must be above 0 s");
  std::vector<ImagePair> pairs;
  if (const fs::path list = folder / "associations.txt"; fs::exists(list)) {
    pairs = read_associations(list);
    if (pairs.empty()) {
      throw Error(list.string() + ": names no images; delete it to associate by time stamp");
    }
  } else {
    pairs = pair_by_time(folder, options.max_difference);
  }
  return pairs;
}

}  // namespace

std::unique_ptr<RgbdSource> open_tum_folder(const std::string& folder, const Camera& camera,
                                            const TumOptions& options) {
  return play_folder({folder, list_pairs(folder, options), nullptr}, camera, options);
}

}  // namespace dkp_slam

#include "dkp_slam/sensor/tum_source.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
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

/// Notes which depth image the stamps alone would have given, `by_stamp`, where it is another.
void add_stamped(const std::vector<std::pair<std::size_t, std::size_t>>& by_stamp,
                 const std::vector<StampedFile>& colour, const std::vector<StampedFile>& depth,
                 std::vector<ImagePair>& pairs) {
  auto pair = pairs.begin();
  for (const auto& [c, d] : by_stamp) {
    while (pair != pairs.end() && pair->timestamp < colour[c].timestamp) ++pair;
    if (pair == pairs.end()) return;
    if (pair->timestamp > colour[c].timestamp || pair->depth == depth[d].path) continue;
    pair->stamped_depth = depth[d].path;
  }
}

std::vector<ImagePair> pair_by_time(const fs::path& folder, double depth_delay,
                                    double max_difference) {
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
  const auto moments = [](const std::vector<StampedFile>& files, double after_stamp) {
    std::vector<double> result;
    for (const StampedFile& file : files) result.push_back(file.timestamp + after_stamp);
    return result;
  };
  std::vector<ImagePair> pairs;
  for (const auto& [c, d] :
       associate(moments(colour, 0.0), moments(depth, depth_delay), max_difference)) {
    pairs.push_back({colour[c].timestamp, colour[c].path, depth[d].path, depth[d].timestamp, ""});
  }
  if (depth_delay != 0.0) {
    add_stamped(associate(moments(colour, 0.0), moments(depth, 0.0), max_difference), colour, depth,
                pairs);
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

/// A list's pairs went by time stamps. Where depth is known to be taken `delay` after its own, each
/// colour image gets the depth image of the list that was taken nearest to it.
void pair_by_moment(std::vector<ImagePair>& pairs, double delay) {
  std::vector<ImagePair> depth = pairs;
  const auto earlier = [](const ImagePair& a, const ImagePair& b) {
    return a.depth_timestamp < b.depth_timestamp;
  };
  std::sort(depth.begin(), depth.end(), earlier);
  for (ImagePair& pair : pairs) {
    ImagePair wanted;
    wanted.depth_timestamp = pair.timestamp - delay;
    auto nearest = std::lower_bound(depth.begin(), depth.end(), wanted, earlier);
    const bool before =
        nearest == depth.end() ||
        (nearest != depth.begin() && wanted.depth_timestamp - std::prev(nearest)->depth_timestamp <
                                         nearest->depth_timestamp - wanted.depth_timestamp);
    if (before) --nearest;
    if (nearest->depth != pair.depth) pair.stamped_depth = std::move(pair.depth);
    pair.depth = nearest->depth;
    pair.depth_timestamp = nearest->depth_timestamp;
  }
}

std::vector<ImagePair> list_pairs(const fs::path& folder, double depth_delay,
                                  double max_difference) {
  if (!fs::exists(folder)) throw Error(folder.string() + ": no such folder; check the path");
  if (!fs::is_directory(folder)) {
    throw Error(folder.string() + ": is no folder; give the folder that holds rgb.txt");
  }
  if (!(max_difference > 0.0)) throw Error("max_difference must be above 0 s");
  std::vector<ImagePair> pairs;
  if (const fs::path list = folder / "associations.txt"; fs::exists(list)) {
    pairs = read_associations(list);
    if (pairs.empty()) {
      throw Error(list.string() + ": names no images; delete it to associate by time stamp");
    }
    if (depth_delay != 0.0) pair_by_moment(pairs, depth_delay);
  } else {
    pairs = pair_by_time(folder, depth_delay, max_difference);
  }
  return pairs;
}

}  // namespace

std::unique_ptr<RgbdSource> open_tum_folder(const std::string& folder, const Camera& camera,
                                            const TumOptions& options) {
  return play_folder(
      {folder, list_pairs(folder, camera.depth_correction.delay, options.max_difference), nullptr},
      camera, options);
}

}  // namespace dkp_slam

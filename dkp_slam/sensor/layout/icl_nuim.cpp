// ICL-NUIM's "TUM RGB-D compatible" sequences: rgb/N.png and depth/N.png, no time stamps.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"
#include "dkp_slam/sensor/layout/image_layout.h"
#include "dkp_slam/sensor/layout/numbered_images.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

NumberedFiles images_in(const fs::path& folder) { return numbered_files(folder, "", {".png"}); }

/// Its associations.txt counts images instead of telling the time.
bool counts_images(const fs::path& list) {
  try {
    const auto pairs = read_associations(list);
    return !pairs.empty() && std::all_of(pairs.begin(), pairs.end(), [](const ImagePair& pair) {
      return fs::path(pair.colour).stem() == fmt::format("{:.0f}", pair.timestamp);
    });
  } catch (const Error&) {  // to be said when it is opened
    return false;
  }
}

/// The dataset's file with the true path; empty where there is none.
fs::path truth_file(const fs::path& folder) {
  fs::path found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->path().filename().string().ends_with(".gt.freiburg")) continue;
    if (!found.empty()) {
      throw Error(fmt::format("{}: {} and {}: keep the one of this sequence", folder.string(),
                              std::min(found, entry->path()).filename().string(),
                              std::max(found, entry->path()).filename().string()));
    }
    found = entry->path();
  }
  return found;
}

/// "N tx ty tz qx qy qz qw" of a camera whose y axis points up, in a world whose does, too: the
/// axes of the ray tracer, to which the negative fy of the dataset's page belongs. With y mirrored
/// in both it is the path of a camera with a positive one, which sees the same images.
StampedPose mirrored_pose(const std::string& line, const std::string& where, double rate) {
  constexpr std::size_t columns = 8;
  std::istringstream stream(line);
  std::vector<double> values;
  for (std::string word; stream >> word;) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      throw Error(fmt::format("{}: \"{}\" is no number", where, word.substr(0, 20)));
    }
    values.push_back(value);
  }
  if (values.size() != columns) throw Error(where + ": expected \"N tx ty tz qx qy qz qw\"");
  const Eigen::Quaterniond rotation(values[7], -values[4], values[5], -values[6]);
  constexpr double least = 1e-6;
  if (!(rotation.norm() > least && std::isfinite(rotation.norm()))) {
    throw Error(where + ": its quaternion is no rotation");
  }
  return {values[0] / rate, {rotation.normalized(), {values[1], -values[2], values[3]}}};
}

class IclNuim : public ImageLayout {
 public:
  bool fits(const fs::path& folder) const override {
    if (fs::exists(folder / "rgb.txt")) return false;
    if (const fs::path list = folder / "associations.txt"; fs::exists(list)) {
      return counts_images(list);
    }
    return !images_in(folder / "rgb").empty() && fs::is_directory(folder / "depth");
  }

  std::vector<ImagePair> pairs(const fs::path& folder, double rate) const override {
    if (const fs::path list = folder / "associations.txt"; fs::exists(list)) {
      std::vector<ImagePair> pairs = read_associations(list);
      for (ImagePair& pair : pairs) {
        pair.timestamp /= rate;
        pair.depth_timestamp = pair.timestamp;  // rendered at one moment
      }
      return pairs;
    }
    return pair_by_number(folder, "rgb", images_in(folder / "rgb"), "depth",
                          images_in(folder / "depth"), rate);
  }

  std::unique_ptr<ImageFit> fit(const fs::path&, const Camera&) const override { return nullptr; }
  std::optional<Camera> own_camera(const fs::path&) const override { return std::nullopt; }
  std::string camera_file(const fs::path& folder) const override {
    const bool its_own = fs::exists(folder / "associations.txt") || !truth_file(folder).empty();
    return its_own ? "icl_nuim.yaml" : "";
  }

  Trajectory truth(const fs::path& folder, double rate) const override {
    if (const fs::path file = truth_file(folder); !file.empty()) return read_icl_truth(file, rate);
    const fs::path renamed = folder / "groundtruth.txt";
    if (!fs::exists(renamed)) return {};
    Trajectory path = read_icl_truth(renamed, 1.0);
    // Anybody's path by the clock has parts of seconds, and its axes are the usual ones.
    if (!std::all_of(path.begin(), path.end(), [](const StampedPose& pose) {
          return pose.timestamp == std::floor(pose.timestamp);
        })) {
      return {};
    }
    for (StampedPose& pose : path) pose.timestamp /= rate;
    return path;
  }
};

}  // namespace

Trajectory read_icl_truth(const fs::path& file, double rate) {
  constexpr std::uintmax_t most = 100'000'000;
  std::ifstream stream = open_text(file, most, "cannot be read", "check that it may be read");
  Trajectory path;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    line.resize(std::min(line.size(), line.find('#')));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const StampedPose pose = mirrored_pose(line, fmt::format("{}:{}", file.string(), number), rate);
    if (!path.empty() && !(pose.timestamp > path.back().timestamp)) {
      throw Error(fmt::format("{}:{}: the images' numbers must rise", file.string(), number));
    }
    path.push_back(pose);
  }
  return path;
}

std::unique_ptr<ImageLayout> icl_nuim_layout() { return std::make_unique<IclNuim>(); }

}  // namespace dkp_slam

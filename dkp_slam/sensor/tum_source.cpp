#include "dkp_slam/sensor/tum_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/mask_folder.h"
#include "dkp_slam/sensor/tum_lists.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

std::vector<ImagePair> pair_by_time(const fs::path& folder, double max_difference) {
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    if (!fs::exists(folder / list)) {
      throw Error(
          fmt::format("{}: no {} in this folder; a TUM or Bonn sequence has rgb.txt and "
                      "depth.txt, or associations.txt",
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
  if (options.first_frame >= pairs.size()) {
    throw Error(fmt::format("{}: has {} frames, so none is left from frame {} on", folder.string(),
                            pairs.size(), options.first_frame));
  }
  pairs.erase(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(options.first_frame));
  if (options.frame_limit && *options.frame_limit < pairs.size()) {
    pairs.resize(*options.frame_limit);
  }
  return pairs;
}

std::vector<std::string> colour_files(const std::vector<ImagePair>& pairs) {
  std::vector<std::string> files;
  for (const ImagePair& pair : pairs) files.push_back(pair.colour);
  return files;
}

class TumSource : public RgbdSource {
 public:
  TumSource(const std::string& folder, const Camera& camera, const TumOptions& options)
      : folder_(folder),
        camera_(camera),
        correction_(options.depth),
        pairs_(list_pairs(folder, options)),
        reader_(most_pixels(camera)) {
    if (!options.masks.empty()) masks_.emplace(options.masks, colour_files(pairs_));
    // The first readable frame shows wrong types and sizes before a long run begins.
    constexpr std::size_t attempts = 10;
    for (std::size_t i = 0; i < std::min(attempts, pairs_.size()); ++i) {
      Problem problem;
      const auto frame = load(i, &problem);
      if (problem.of_kind) throw Error(problem.text);
      if (!frame) continue;
      if (masks_) masks_->check(pairs_[i].colour, frame->colour.size());
      break;
    }
  }

  std::string description() const override { return folder_; }
  std::optional<std::size_t> size() const override { return pairs_.size(); }
  std::size_t skipped() const override { return skipped_; }
  std::size_t without_mask() const override { return masks_ ? masks_->missing() : 0; }

  std::optional<RgbdFrame> read() override {
    while (next_ < pairs_.size()) {
      Problem problem;
      if (auto frame = load(next_++, &problem)) {
        if (masks_) frame->mask = masks_->read(pairs_[next_ - 1].colour, frame->colour.size());
        return frame;
      }
      spdlog::warn("{}; frame {} skipped", problem.text, next_ - 1);
      if (++skipped_ * 2 > pairs_.size()) {
        throw Error(fmt::format("{}: {} of {} frames cannot be read; the last one: {}", folder_,
                                skipped_, pairs_.size(), problem.text));
      }
    }
    return std::nullopt;
  }

 private:
  /// Why there is no frame.
  struct Problem {
    std::string text;
    bool of_kind = false;  ///< the images could be read, but have a wrong type or size
  };

  /// Images of another camera are to be recognised as such, those of no camera not to be decoded.
  static std::uint64_t most_pixels(const Camera& camera) {
    constexpr std::uint64_t times = 4;
    return std::max(ImageReader::usual_most_pixels, times *
                                                        static_cast<std::uint64_t>(camera.width) *
                                                        static_cast<std::uint64_t>(camera.height));
  }

  /// Nothing, and why, when an image is missing, damaged or of the wrong kind.
  std::optional<RgbdFrame> load(std::size_t index, Problem* problem) {
    const ImagePair& pair = pairs_[index];
    const std::string colour_path = fs::path(folder_) / pair.colour;
    const std::string depth_path = fs::path(folder_) / pair.depth;
    ImageRead colour = reader_.read_colour(colour_path);
    if (colour.image.empty()) {
      problem->text = fmt::format("{}: {}", colour_path, colour.problem);
      return std::nullopt;
    }
    const ImageRead depth = reader_.read_unchanged(depth_path);
    if (depth.image.empty()) {
      problem->text = fmt::format("{}: {}", depth_path, depth.problem);
      return std::nullopt;
    }
    problem->text = problem_of(colour_path, colour.image, depth_path, depth.image);
    problem->of_kind = !problem->text.empty();
    if (problem->of_kind) return std::nullopt;
    RgbdFrame frame;
    frame.index = static_cast<int>(index);
    frame.timestamp = pair.timestamp;
    frame.depth_delay = pair.depth_timestamp + correction_.delay - pair.timestamp;
    frame.colour = std::move(colour.image);
    frame.depth =
        depth_in_metres(depth.image, camera_.depth_scale, camera_.min_depth, camera_.max_depth);
    if (correction_.bias != 0.0)
      cv::add(frame.depth, correction_.bias, frame.depth, frame.depth > 0);
    return frame;
  }

  /// What is wrong with the images' types and sizes, or nothing.
  std::string problem_of(const std::string& colour_path, const cv::Mat& colour,
                         const std::string& depth_path, const cv::Mat& depth) const {
    if (depth.type() != CV_16UC1) {
      return fmt::format(
          "{}: depth must be a 16-bit image of one channel, not {} bits and {} channels",
          depth_path, depth.elemSize1() * 8, depth.channels());
    }
    if (depth.size() != colour.size()) {
      return fmt::format(
          "{}: depth is {} x {} pixels but its colour image is {} x {}; depth must be registered "
          "to colour",
          depth_path, depth.cols, depth.rows, colour.cols, colour.rows);
    }
    if (colour.cols != camera_.width || colour.rows != camera_.height) {
      return fmt::format(
          "{}: is {} x {} pixels but the camera file says {} x {}; use the camera file of this "
          "sequence",
          colour_path, colour.cols, colour.rows, camera_.width, camera_.height);
    }
    return "";
  }

  std::string folder_;
  Camera camera_;
  DepthCorrection correction_;
  std::vector<ImagePair> pairs_;
  ImageReader reader_;
  std::optional<MaskFolder> masks_;
  std::size_t next_ = 0;
  std::size_t skipped_ = 0;
};

}  // namespace

std::unique_ptr<RgbdSource> open_tum_folder(const std::string& folder, const Camera& camera,
                                            const TumOptions& options) {
  if (const auto reason = camera.check()) throw Error("camera: " + *reason);
  return std::make_unique<TumSource>(folder, camera, options);
}

}  // namespace dkp_slam

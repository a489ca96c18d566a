#include "dkp_slam/sensor/folder_source.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/mask_folder.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

/// The pairs that are wanted.
std::vector<ImagePair> chosen(const std::string& folder, std::vector<ImagePair> pairs,
                              const TumOptions& options) {
  if (options.first_frame >= pairs.size()) {
    throw Error(fmt::format("{}: has {} frames, so none is left from frame {} on", folder,
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

class FolderSource : public RgbdSource {
 public:
  FolderSource(FolderImages images, const Camera& camera, const TumOptions& options)
      : folder_(std::move(images.folder)),
        camera_(camera),
        corrector_(camera.depth_correction, {camera.width, camera.height}),
        pairs_(chosen(folder_, std::move(images.pairs), options)),
        fit_(std::move(images.fit)),
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
    ImageRead colour = reader_.read_colour(colour_path);
    if (colour.image.empty()) {
      problem->text = fmt::format("{}: {}", colour_path, colour.problem);
      return std::nullopt;
    }
    RgbdFrame frame;
    frame.index = static_cast<int>(index);
    frame.timestamp = pair.timestamp;
    frame.depth_delay = pair.depth_timestamp + camera_.depth_correction.delay - pair.timestamp;
    frame.colour = std::move(colour.image);
    frame.depth = load_depth(pair.depth, colour_path, frame.colour, problem);
    if (frame.depth.empty()) return std::nullopt;
    if (!pair.stamped_depth.empty()) {
      Problem unimportant;
      frame.stamped_depth = load_depth(pair.stamped_depth, colour_path, frame.colour, &unimportant);
    }
    return frame;
  }

  /// Metres; empty, and why, where there is none. Of `colour`, fits what has to fit.
  cv::Mat load_depth(const std::string& file, const std::string& colour_path, cv::Mat& colour,
                     Problem* problem) {
    for (const auto& [name, image] : decoded_) {
      if (name == file && !fit_) return image;
    }
    const std::string path = fs::path(folder_) / file;
    ImageRead depth = reader_.read_unchanged(path);
    if (depth.image.empty()) {
      problem->text = fmt::format("{}: {}", path, depth.problem);
      return {};
    }
    problem->text = problem_of(colour_path, colour, path, depth.image);
    problem->of_kind = !problem->text.empty();
    if (problem->of_kind) return {};
    if (fit_ && fit_->unknown() != 0) depth.image.setTo(0, depth.image == fit_->unknown());
    cv::Mat metres =
        depth_in_metres(depth.image, camera_.depth_scale, camera_.min_depth, camera_.max_depth);
    if (fit_) fit_->apply(colour, metres);
    corrector_.apply(metres);
    std::swap(decoded_[0], decoded_[1]);
    decoded_[1] = {file, metres};
    return metres;
  }

  /// What is wrong with the images' types and sizes, or nothing.
  std::string problem_of(const std::string& colour_path, const cv::Mat& colour,
                         const std::string& depth_path, const cv::Mat& depth) const {
    if (depth.type() != CV_16UC1) {
      return fmt::format(
          "{}: depth must be a 16-bit image of one channel, not {} bits and {} channels",
          depth_path, depth.elemSize1() * 8, depth.channels());
    }
    if (fit_) {
      const std::string problem = fit_->problem_of(colour.size(), depth.size());
      return problem.empty() ? "" : fmt::format("{}: {}", colour_path, problem);
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
  DepthCorrector corrector_;
  std::vector<ImagePair> pairs_;
  std::unique_ptr<ImageFit> fit_;
  ImageReader reader_;
  std::optional<MaskFolder> masks_;
  /// The last two: the stamped depth of one frame mostly is the depth of the frame before.
  std::array<std::pair<std::string, cv::Mat>, 2> decoded_;
  std::size_t next_ = 0;
  std::size_t skipped_ = 0;
};

}  // namespace

std::unique_ptr<RgbdSource> play_folder(FolderImages images, const Camera& camera,
                                        const TumOptions& options) {
  if (const auto reason = camera.check()) throw Error("camera: " + *reason);
  return std::make_unique<FolderSource>(std::move(images), camera, options);
}

}  // namespace dkp_slam

// ScanNet as its reader exports it: color/N.jpg, depth/N.png, pose/N.txt and intrinsic/.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/layout/image_layout.h"
#include "dkp_slam/sensor/layout/numbered_images.h"
#include "dkp_slam/sensor/layout/pose_text.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

NumberedFiles colour_files_of(const fs::path& folder) {
  return numbered_files(folder / "color", "", {".jpg", ".png", ".jpeg"});
}

NumberedFiles depth_files_of(const fs::path& folder) {
  return numbered_files(folder / "depth", "", {".png"});
}

/// `kind`: color or depth. Beside the images in parts of the dataset that come ready made.
Intrinsics intrinsics_of(const fs::path& folder, const std::string& kind) {
  for (const fs::path& file : {folder / "intrinsic" / ("intrinsic_" + kind + ".txt"),
                               folder / ("intrinsics_" + kind + ".txt")}) {
    if (fs::exists(file)) return intrinsics_of_matrix(read_matrix(file), file);
  }
  throw Error(
      fmt::format("{}: no intrinsic/intrinsic_{}.txt in this folder; ScanNet's reader "
                  "exports it with the images (--export_intrinsics)",
                  folder.string(), kind));
}

/// Both cameras are one in ScanNet. What is not, is of no convention that anybody wrote down.
void check_extrinsics(const fs::path& folder) {
  for (const char* name : {"extrinsic_color.txt", "extrinsic_depth.txt"}) {
    const fs::path file = folder / "intrinsic" / name;
    if (!fs::exists(file)) continue;
    constexpr double same = 1e-6;
    if (!((read_matrix(file) - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() < same)) {
      throw Error(file.string() +
                  ": must be the identity, as in ScanNet: depth seen from elsewhere is to be "
                  "registered to colour first");
    }
  }
}

/// Size of the first image that can be read.
cv::Size first_size(const fs::path& folder, const NumberedFiles& files) {
  ImageReader reader;
  std::string problem = "there is none";
  constexpr int attempts = 10;
  int tried = 0;
  for (const auto& [number, name] : files) {
    if (tried++ == attempts) break;
    const ImageRead image = reader.read_unchanged(folder / name);
    if (!image.image.empty()) return image.image.size();
    problem = fmt::format("{}: {}", name, image.problem);
  }
  throw Error(fmt::format("{}: no image can be read ({})", folder.string(), problem));
}

/// Resamples colour into the pixels of depth: two cameras at one place that look one way differ in
/// scale and centre alone. Depth stays as it was measured.
class ScanNetFit : public ImageFit {
 public:
  ScanNetFit(const Intrinsics& from, const cv::Size& colour, const Intrinsics& to,
             const cv::Size& depth)
      : colour_(colour), depth_(depth) {
    const double scale_x = from.fx / to.fx, scale_y = from.fy / to.fy;
    // Whole pixels are averaged first, for what is skipped makes corners that are none.
    shrink_ = std::max(1, static_cast<int>(std::floor(std::min(scale_x, scale_y) + 0.25)));
    const double middle = 0.5 * (shrink_ - 1);
    const auto start = [&](double scale, double c_to, double c_from) {
      return (c_from - scale * c_to - middle) / shrink_;
    };
    colour_from_depth_ = {scale_x / shrink_,
                          0.0,
                          start(scale_x, to.cx, from.cx),
                          0.0,
                          scale_y / shrink_,
                          start(scale_y, to.cy, from.cy)};
  }

  std::string problem_of(const cv::Size& colour, const cv::Size& depth) const override {
    if (depth != depth_) {
      return fmt::format("its depth image is {} x {} pixels but the camera file says {} x {}",
                         depth.width, depth.height, depth_.width, depth_.height);
    }
    if (colour == colour_) return "";
    return fmt::format("is {} x {} pixels, those before were {} x {}", colour.width, colour.height,
                       colour_.width, colour_.height);
  }

  void apply(cv::Mat& colour, cv::Mat&) const override {
    cv::Mat smaller = colour;
    if (shrink_ > 1) {
      const cv::Size size(colour.cols / shrink_, colour.rows / shrink_);
      cv::resize(colour(cv::Rect(0, 0, size.width * shrink_, size.height * shrink_)), smaller, size,
                 0.0, 0.0, cv::INTER_AREA);
    }
    // Depth may see a little past colour's edge, which then goes on.
    cv::Mat seen;
    cv::warpAffine(smaller, seen, colour_from_depth_, depth_,
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    colour = seen;
  }

 private:
  const cv::Size colour_, depth_;
  int shrink_ = 1;
  cv::Matx23d colour_from_depth_;  // pixels, of the image that was shrunk
};

class ScanNet : public ImageLayout {
 public:
  bool fits(const fs::path& folder) const override {
    return !colour_files_of(folder).empty() && fs::is_directory(folder / "depth");
  }
  std::vector<ImagePair> pairs(const fs::path& folder, double rate) const override {
    return pair_by_number(folder, "color", colour_files_of(folder), "depth", depth_files_of(folder),
                          rate);
  }

  std::unique_ptr<ImageFit> fit(const fs::path& folder, const Camera& camera) const override {
    check_extrinsics(folder);
    const Intrinsics colour = intrinsics_of(folder, "color");
    const cv::Size size = first_size(folder / "color", colour_files_of(folder));
    constexpr double middle = 0.1;  // of the width and the height
    if (std::abs(colour.cx / size.width - 0.5) > middle ||
        std::abs(colour.cy / size.height - 0.5) > middle) {
      throw Error(fmt::format(
          "{}: the colour camera's centre is {:g}, {:g} but its images are {} x {} pixels: were "
          "they resized? give intrinsic_color.txt the numbers of the smaller images",
          folder.string(), colour.cx, colour.cy, size.width, size.height));
    }
    return std::make_unique<ScanNetFit>(colour, size, intrinsics_of(folder, "depth"),
                                        cv::Size(camera.width, camera.height));
  }

  std::optional<Camera> own_camera(const fs::path& folder) const override {
    const Intrinsics depth = intrinsics_of(folder, "depth");
    const cv::Size size = first_size(folder / "depth", depth_files_of(folder));
    Camera camera;
    camera.name = "ScanNet (intrinsic_depth.txt)";
    camera.width = size.width;
    camera.height = size.height;
    camera.fx = depth.fx;
    camera.fy = depth.fy;
    camera.cx = depth.cx;
    camera.cy = depth.cy;
    camera.depth_scale = 1000.0;
    if (const auto reason = camera.check()) {
      throw Error(fmt::format("{}: intrinsic_depth.txt: {}", folder.string(), *reason));
    }
    return camera;
  }

  std::string camera_file(const fs::path&) const override { return ""; }

  Trajectory truth(const fs::path& folder, double rate) const override {
    Trajectory path;
    for (const auto& [number, name] : numbered_files(folder / "pose", "", {".txt"})) {
      const fs::path file = folder / "pose" / name;
      const auto pose = pose_of_matrix(read_matrix(file), file);
      if (pose) path.push_back({static_cast<double>(number) / rate, *pose});
    }
    return path;
  }
};

}  // namespace

std::unique_ptr<ImageLayout> scannet_layout() { return std::make_unique<ScanNet>(); }

}  // namespace dkp_slam

// Microsoft's 7-Scenes: frame-N.color.png, frame-N.depth.png, frame-N.pose.txt.
#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/depth_registration.h"
#include "dkp_slam/sensor/layout/image_layout.h"
#include "dkp_slam/sensor/layout/numbered_images.h"
#include "dkp_slam/sensor/layout/pose_text.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

constexpr int unknown_depth = 65535;

NumberedFiles files_of(const fs::path& folder, const char* ending) {
  return numbered_files(folder, "frame-", {ending});
}

/// What the dataset's page gives for the depth camera.
Camera depth_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 585.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  return camera;
}

/// The dataset gives no pose between the cameras. In a Kinect the colour camera sits 25 mm to the
/// right of the infrared one, as the camera sees it, and looks the same way but for a few tenths of
/// a degree that differ from one to the next.
Se3 colour_from_depth() { return {Eigen::Quaterniond::Identity(), {-0.025, 0.0, 0.0}}; }

class SevenScenesFit : public ImageFit {
 public:
  explicit SevenScenesFit(const Camera& colour)
      : colour_(colour.width, colour.height),
        depth_(depth_camera().width, depth_camera().height),
        registration_(depth_camera(), colour, colour_from_depth()) {}

  int unknown() const override { return unknown_depth; }
  std::string problem_of(const cv::Size& colour, const cv::Size& depth) const override {
    if (depth != depth_) {
      return fmt::format("its depth image is {} x {} pixels, not {} x {} as 7-Scenes has them",
                         depth.width, depth.height, depth_.width, depth_.height);
    }
    if (colour == colour_) return "";
    return fmt::format(
        "is {} x {} pixels but the camera file says {} x {}; use the camera file of this sequence",
        colour.width, colour.height, colour_.width, colour_.height);
  }
  void apply(cv::Mat&, cv::Mat& depth) const override { depth = registration_.registered(depth); }

 private:
  const cv::Size colour_, depth_;
  const DepthRegistration registration_;
};

class SevenScenes : public ImageLayout {
 public:
  bool fits(const fs::path& folder) const override {
    return !files_of(folder, ".color.png").empty();
  }
  std::vector<ImagePair> pairs(const fs::path& folder, double rate) const override {
    return pair_by_number(folder, "", files_of(folder, ".color.png"), "",
                          files_of(folder, ".depth.png"), rate);
  }
  std::unique_ptr<ImageFit> fit(const fs::path&, const Camera& camera) const override {
    return std::make_unique<SevenScenesFit>(camera);
  }
  std::optional<Camera> own_camera(const fs::path&) const override { return std::nullopt; }

  std::string camera_file(const fs::path&) const override { return "seven_scenes.yaml"; }

  /// The files tell where the depth camera was: it is what KinectFusion tracked.
  Trajectory truth(const fs::path& folder, double rate) const override {
    const Se3 depth_from_colour = colour_from_depth().inverse();
    Trajectory path;
    for (const auto& [number, name] : files_of(folder, ".pose.txt")) {
      const auto pose = pose_of_matrix(read_matrix(folder / name), folder / name);
      if (pose) path.push_back({static_cast<double>(number) / rate, *pose * depth_from_colour});
    }
    return path;
  }
};

}  // namespace

std::unique_ptr<ImageLayout> seven_scenes_layout() { return std::make_unique<SevenScenes>(); }

}  // namespace dkp_slam

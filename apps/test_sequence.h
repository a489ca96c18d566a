#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/camera_config.h"

namespace dkp_slam::testing {

/// As long as most tests need a sequence.
inline constexpr int frame_count = 12;

/// A camera that glides along a patterned wall two metres away, three pixels to the right a frame:
/// images, depth and poses are exact, and quickly made. Written as a TUM folder with camera.yaml.
class WallSequence {
 public:
  static constexpr double depth = 2.0;
  static constexpr int step = 3;

  WallSequence(std::filesystem::path folder, int frames) : folder_(std::move(folder)) {
    namespace fs = std::filesystem;
    fs::create_directories(folder_ / "rgb");
    fs::create_directories(folder_ / "depth");
    camera.fx = camera.fy = 500.0;
    camera.cx = 319.5;
    camera.cy = 239.5;
    save_camera(camera, (folder_ / "camera.yaml").string());
    constexpr int tile = 12;
    cv::Mat tiles(480 / tile, (640 + step * frames) / tile + 1, CV_8UC3), wall;
    cv::RNG(7).fill(tiles, cv::RNG::UNIFORM, 0, 256);
    cv::resize(tiles, wall, {}, tile, tile, cv::INTER_NEAREST);
    const cv::Mat raw(480, 640, CV_16U, cv::Scalar(depth * camera.depth_scale));
    Trajectory truth;
    std::ofstream rgb(folder_ / "rgb.txt"), depths(folder_ / "depth.txt");
    for (int i = 0; i < frames; ++i) {
      write_image(colour_file(i), wall(cv::Rect(step * i, 0, 640, 480)));
      write_image(depth_file(i), raw);
      rgb << stamp(i) << " rgb/" << stamp(i) << ".png\n";
      depths << stamp(i) << " depth/" << stamp(i) << ".png\n";
      StampedPose pose{std::stod(stamp(i)), {}};
      pose.world_from_camera.translation.x() = step * i * depth / camera.fx;
      truth.push_back(pose);
    }
    write_trajectory(folder_ / "groundtruth.txt", truth);
  }

  /// Five minutes more by the clock, ten frames a second: for what must come in the middle of a
  /// run. `image`: which of the images is seen in the i-th of these frames.
  void prolong(const std::function<int(int)>& image) const {
    for (const char* kind : {"rgb", "depth"}) {
      std::ofstream list(folder_ / fmt::format("{}.txt", kind), std::ios::app);
      for (int i = 1; i < 3000; ++i) {
        list << fmt::format("{:.6f} {}/{}.png\n", 10.4 + i * 0.1, kind, stamp(image(i)));
      }
    }
  }

  static std::string stamp(int i) { return fmt::format("{:.6f}", 10.0 + i / 30.0); }
  std::string colour_file(int i) const { return folder_ / "rgb" / (stamp(i) + ".png"); }
  std::string depth_file(int i) const { return folder_ / "depth" / (stamp(i) + ".png"); }
  const std::filesystem::path& folder() const { return folder_; }

  Camera camera;

 private:
  std::filesystem::path folder_;
};

}  // namespace dkp_slam::testing

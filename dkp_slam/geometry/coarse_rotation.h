#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// How a camera has turned from one frame to the next, found on blurred images 80 pixels wide
/// (small blurry images: Klein and Murray, "Improving the Agility of Keyframe-Based SLAM", ECCV
/// 2008). Coarse, about a tenth of a degree to half a degree, but it needs no corners, which a fast
/// turn blurs, and no idea where to begin: it finds turns of ten degrees and more.
class CoarseRotation {
 public:
  explicit CoarseRotation(const Camera& camera);

  /// Makes `grey` (CV_8UC1, the camera's size) the newest frame. `hidden`: boxes, raw pixels, of
  /// what may move by itself in it.
  void push(const cv::Mat& grey, const std::vector<cv::Rect2f>& hidden);
  /// Rotation of the frame before from the newest one. Nothing when there is no frame before, or
  /// when what is seen outside the boxes does not tell.
  std::optional<Eigen::Quaterniond> previous_from_current() const;

 private:
  struct Small {
    cv::Mat grey;     // CV_32FC1
    cv::Mat visible;  // CV_8UC1, 255 outside the boxes
  };
  struct Blurred {
    cv::Mat grey, dx, dy;  // CV_32FC1
  };
  static Blurred blurred(const cv::Mat& grey, double sigma);
  std::optional<Eigen::Vector4d> step(const Blurred& previous, const cv::Mat& current,
                                      const Eigen::Quaterniond& rotation, double offset) const;

  cv::Size size_;
  double fx_, fy_, cx_, cy_;  // of the small image, without distortion
  double scale_x_, scale_y_;  // small pixels in one of the camera's
  Small now_, before_;
};

}  // namespace dkp_slam

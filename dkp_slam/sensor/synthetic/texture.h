#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace dkp_slam {

/// An image on a surface, filtered so that it does not alias: trilinear in a pyramid, with several
/// taps along the longer axis of a pixel's footprint.
class Texture {
 public:
  /// `bgr` is CV_8UC3. With `wrap`, the left and right edges meet (cloth around a limb); its width
  /// should be a power of two then.
  explicit Texture(const cv::Mat& bgr, bool wrap = false);

  /// BGR, 0 to 255, at `uv` (0 to 1 over the image); `du` and `dv` are the changes of uv from one
  /// pixel of the camera to the next, right and down.
  cv::Vec3f sample(const Eigen::Vector2d& uv, const Eigen::Vector2d& du,
                   const Eigen::Vector2d& dv) const;

 private:
  cv::Vec3f bilinear(int level, const Eigen::Vector2d& uv) const;

  std::vector<cv::Mat> levels_;
  bool wrap_;
};

}  // namespace dkp_slam

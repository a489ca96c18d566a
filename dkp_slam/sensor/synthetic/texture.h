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
  cv::Vec3f sample(const Eigen::Vector2f& uv, const Eigen::Vector2f& du,
                   const Eigen::Vector2f& dv) const;
  cv::Vec3f sample(const Eigen::Vector2d& uv, const Eigen::Vector2d& du,
                   const Eigen::Vector2d& dv) const {
    return sample(uv.cast<float>().eval(), du.cast<float>().eval(), dv.cast<float>().eval());
  }
  /// Of the whole image, BGR, 0 to 255.
  cv::Vec3f mean() const;

 private:
  struct Level {
    int width, height;
    std::vector<cv::Vec4b> texels;  ///< row by row; the fourth byte is idle
  };
  cv::Vec3f bilinear(const Level& level, const Eigen::Vector2f& uv) const;

  std::vector<Level> levels_;
  bool wrap_;
};

/// Linear light, 0 to 1, of a grey level, 0 to 255, in sRGB (IEC 61966-2-1).
float linear_light(float level);

}  // namespace dkp_slam

#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace dkp_slam {

/// How a depth camera's readings are off across its image. A structured-light or stereo camera
/// measures disparities, the inverse of depth, and its lenses shift these by a little that changes
/// slowly over the image (Herrera C., Kannala, Heikkila 2012, "Joint Depth and Color Camera
/// Calibration with Distortion Correction"): here by a polynomial of third degree,
///   1/depth = 1/reading + coefficients . terms(pixel).
/// It has no constant: that would be a scale and a bias, which are kept apart.
struct DepthDistortion {
  static constexpr int size = 9;
  using Terms = Eigen::Matrix<double, size, 1>;

  Terms coefficients = Terms::Zero();  ///< 1/metre

  bool none() const { return coefficients.isZero(0.0); }
  /// x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3 of a raw pixel, where x and y go from -1 to 1 over
  /// the image's width and height.
  static Terms terms(const Eigen::Vector2d& pixel, const cv::Size& image);
};

/// What is wrong with a camera's depth images beside their scale: the readers of folders, bags and
/// a Kinect put it right.
struct DepthCorrection {
  /// Seconds by which the light of a depth image came later than its time stamp says, compared with
  /// the colour images' stamps; negative when it came earlier.
  double delay = 0.0;
  /// Metres to be added to every known depth once it is in metres, after the distortion.
  double bias = 0.0;
  DepthDistortion distortion = {};
};

/// Puts depth images of one size right.
class DepthCorrector {
 public:
  DepthCorrector() = default;  ///< changes nothing
  DepthCorrector(const DepthCorrection& correction, const cv::Size& size);

  /// `depth`: CV_32FC1, metres, 0 unknown, of the size given. A reading that the distortion would
  /// more than double becomes unknown.
  void apply(cv::Mat& depth) const;

 private:
  float bias_ = 0.0F;
  cv::Mat1f offset_;  ///< 1/metre, of the inverse depth; empty: none
};

}  // namespace dkp_slam

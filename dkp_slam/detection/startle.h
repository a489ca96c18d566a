#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Share of an image that is nearer than all that lay about it in the image before, from which on
/// somebody has stepped into the view.
inline constexpr double startling_share = 0.02;

/// Tells the images of which those before say little: somebody may be there who was not.
class Startle {
 public:
  /// `least`: share of the image, as `startling_share`.
  explicit Startle(double least = startling_share) : least_(least) {}

  /// Whether enough has come nearer, in this image or a few before: a sensor's colour may show with
  /// the next image what its depth has shown with this one. Or whether the image is the first, or
  /// one of the first after a gap. Asked once for every image, in order of `time` (seconds), with
  /// its depth (CV_32FC1, metres, 0 where unknown; may be empty).
  bool by(double time, const cv::Mat& depth);

 private:
  bool somebody_came(double time, const cv::Mat& depth);

  double least_;
  cv::Mat before_;               // depth of the image before, a grid of 40 columns
  std::optional<double> came_;   // seconds, when enough had come nearer
  std::optional<double> last_;   // seconds, of the image before
  std::optional<double> began_;  // seconds, of the first after the last gap
};

}  // namespace dkp_slam

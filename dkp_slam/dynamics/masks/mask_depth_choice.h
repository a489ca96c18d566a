#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

class OptionList;

struct MaskDepthOptions {
  /// Every how many frames masks are cut from both depth images, to see which fits, half as
  /// often once that is clear; 0: never, and they are cut from `RgbdFrame::depth`.
  int every = 3;
  /// Standard deviation of one comparison: by how much of their sum the gradients differ.
  double spread = 0.15;
  double sigmas = 2.0;   ///< by which one must fit better than the other to be chosen
  double forget = 0.95;  ///< weight of what was seen, a comparison later

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Mean gradient of `grey` (CV_8UC1, image size) along the outlines of two masks (CV_8UC1, image
/// size, not 0 in the mask) where these lie apart.
struct OutlineGradients {
  double first = 0.0, second = 0.0;  ///< grey levels per pixel
  int pixels = 0;                    ///< of the shorter one; the means are of nothing at 0
};
OutlineGradients outline_gradients(const cv::Mat& grey, const cv::Mat& first,
                                   const cv::Mat& second);

/// Which of two depth images shows what moves as the colour image does: the one taken at its moment
/// as the camera's known delay has it (RgbdFrame::depth), or the one with its time stamp
/// (RgbdFrame::stamped_depth). A delay may be wrong, and people who were drawn into a recording
/// have none. An outline cut from the right image lies where colour changes.
class MaskDepthChoice {
 public:
  explicit MaskDepthChoice(const MaskDepthOptions& options) : options_(options) {}

  /// To be asked once for every frame that has both: whether to compare this time.
  bool wants_comparison();
  /// Masks cut from `RgbdFrame::depth` and from the stamped one.
  void compare(const cv::Mat& grey, const cv::Mat& by_moment, const cv::Mat& by_stamp);
  /// Masks are to be cut from the stamped image.
  bool stamped() const { return stamped_; }

 private:
  double sigmas_of_sum() const;  // by which one fits better
  MaskDepthOptions options_;
  int frame_ = 0;
  double sum_ = 0.0;      // of weighted differences, stamped less moment
  double squares_ = 0.0;  // of their weights
  bool stamped_ = false;
};

}  // namespace dkp_slam

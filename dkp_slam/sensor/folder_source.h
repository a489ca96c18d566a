#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/sensor/tum_lists.h"
#include "dkp_slam/sensor/tum_options.h"

namespace dkp_slam {

/// What images need before depth is registered to colour and both have the camera's size.
class ImageFit {
 public:
  virtual ~ImageFit() = default;
  /// Value of a depth image that means that nothing is known, beside 0.
  virtual int unknown() const { return 0; }
  /// What is wrong with images of these sizes, without the file's name; nothing where all is well.
  virtual std::string problem_of(const cv::Size& colour, const cv::Size& depth) const = 0;
  /// Images of sizes that are well; `depth` is CV_32FC1, metres, 0 where unknown.
  virtual void apply(cv::Mat& colour, cv::Mat& depth) const = 0;
};

/// Images in a folder, whatever its layout.
struct FolderImages {
  std::string folder;
  std::vector<ImagePair> pairs;   ///< in the order of their stamps; paths relative to `folder`
  std::unique_ptr<ImageFit> fit;  ///< null where they are what a frame is
};

/// Plays them. Of `options` max_difference is not used: the pairs are there. Throws and skips as
/// `open_tum_folder` does.
std::unique_ptr<RgbdSource> play_folder(FolderImages images, const Camera& camera,
                                        const TumOptions& options);

}  // namespace dkp_slam

#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Turns depth images of a camera of their own into depth images of the colour camera beside it.
class DepthRegistration {
 public:
  DepthRegistration(const Camera& depth, const Camera& colour, const Se3& colour_from_depth);

  /// CV_32FC1 metres, 0 unknown, of the depth camera's size in, of the colour camera's out. A pixel
  /// of depth covers what its square covers in the colour image; the nearest one counts.
  cv::Mat registered(const cv::Mat& depth) const;

 private:
  struct Spot;
  Spot project(int corner, float depth) const;

  Camera depth_, colour_;
  Se3 colour_from_depth_;
  std::vector<Eigen::Vector3d> corners_;  // rays through the corners of pixels, at depth 1
};

}  // namespace dkp_slam

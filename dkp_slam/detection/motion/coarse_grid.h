#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// A frame at the motion detector's working resolution.
struct CoarseView {
  cv::Mat grey;   ///< CV_8UC1
  cv::Mat depth;  ///< CV_32FC1, metres, 0 where unknown
};

/// A grid of cells, each `step` x `step` pixels of the image: the resolution at which the motion
/// detector compares frames. Coordinates in the grid count cells, the centre of the top left one
/// at (0, 0).
class CoarseGrid {
 public:
  /// Chooses the step that brings the camera's image nearest to `columns` cells of width.
  CoarseGrid(const Camera& camera, int columns);

  int step() const { return step_; }
  cv::Size size() const { return size_; }

  /// Grey values averaged over cells, depth of one pixel near each cell's centre (an average would
  /// put points into the air at the edges of objects). `grey` is the image's, full size.
  CoarseView view(const cv::Mat& grey, const cv::Mat& depth) const;

  /// Point at depth 1 on the ray through a cell's centre, lens distortion undone.
  const Eigen::Vector3f& ray(int index) const { return rays_[static_cast<std::size_t>(index)]; }
  /// Grid coordinates of a point in the camera frame (z > 0 is the caller's duty).
  cv::Point2f project(const Eigen::Vector3f& point) const;

 private:
  int step_ = 1;
  cv::Size size_;
  std::vector<Eigen::Vector3f> rays_;
  float fx_, fy_, cx_, cy_;  ///< cells
  Distortion distortion_;
};

}  // namespace dkp_slam

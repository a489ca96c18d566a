#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// How the camera moves while one image is read, row after row (rolling shutter; see
/// at_middle_row, of which this is the first order: people are sought by the tenth of a metre).
class RowMotion {
 public:
  RowMotion() = default;
  /// `readout` in seconds, `velocity` as tangent (translation, rotation) per second.
  RowMotion(double readout, const Vector6d& velocity);

  /// Where a point (camera frame, metres) of the middle row's moment is at that of a row, given as
  /// share of the image's height from the top.
  Eigen::Vector3f at_row(const Eigen::Vector3f& point, float row) const {
    return point + (row - 0.5F) * (turn_.cross(point) + shift_);
  }
  /// The reverse, of a point that the row shows.
  Eigen::Vector3f at_middle(const Eigen::Vector3f& point, float row) const {
    return point - (row - 0.5F) * (turn_.cross(point) + shift_);
  }

 private:
  Eigen::Vector3f shift_ = Eigen::Vector3f::Zero();  // metres, from the first row to the last
  Eigen::Vector3f turn_ = Eigen::Vector3f::Zero();   // radians
};

/// A frame at the motion detector's working resolution.
struct CoarseView {
  cv::Mat grey;    ///< CV_8UC1
  cv::Mat depth;   ///< CV_32FC1, metres, 0 where unknown; taken to be of the colour rows' moments
  RowMotion rows;  ///< none where nobody knows how the camera moved
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
  cv::Point2f project(const Eigen::Vector3f& point) const {
    const float x = point.x() / point.z(), y = point.y() / point.z();
    const float r2 = x * x + y * y;
    const float radial = 1.0F + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
    const float xd = x * radial + 2.0F * p1_ * x * y + p2_ * (r2 + 2.0F * x * x);
    const float yd = y * radial + p1_ * (r2 + 2.0F * y * y) + 2.0F * p2_ * x * y;
    return {fx_ * xd + cx_, fy_ * yd + cy_};
  }

  /// The point that a cell shows at a depth (metres), as it is at the middle row's moment.
  Eigen::Vector3f point(const cv::Point& cell, float depth, const RowMotion& rows) const {
    const auto row = static_cast<float>(cell.y) / static_cast<float>(size_.height);
    return rows.at_middle(depth * ray(cell.y * size_.width + cell.x), row);
  }
  /// A point of the middle row's moment as the row shows it on which it lies. (Distortion moves it
  /// by a few rows, in which nothing moves by a cell.)
  Eigen::Vector3f as_seen(const Eigen::Vector3f& point, const RowMotion& rows) const {
    const float row = fy_ * point.y() / point.z() + cy_;
    return rows.at_row(point, row / static_cast<float>(size_.height));
  }

 private:
  int step_ = 1;
  cv::Size size_;
  std::vector<Eigen::Vector3f> rays_;
  float fx_, fy_, cx_, cy_;       ///< cells
  float k1_, k2_, k3_, p1_, p2_;  ///< of the lens
};

}  // namespace dkp_slam

#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// The features of one frame with everything that tracking and mapping ask of them: undistorted
/// position, depth, pyramid level, orientation, descriptor, and a grid to find them by place.
/// Plain values: a copy is independent.
class FrameFeatures {
 public:
  FrameFeatures() = default;
  /// `depth`: CV_32FC1 metres, 0 unknown, registered to the image the features come from.
  /// `depth_from_colour`: the camera's motion between the two images when they were not taken at
  /// the same moment; each feature's depth is then read where the feature was at the depth image's
  /// moment, and carried back. Identity reads straight through.
  FrameFeatures(const OrbFeatures& orb, const cv::Mat& depth, const Camera& camera,
                const Se3& depth_from_colour = {});
  /// From stored values, all of one length: `pixel` undistorted, depth, level, angle and descriptor
  /// as in the members below. What pixels and depths were before a correction for the rolling
  /// shutter is not known any more; they are taken as never corrected.
  FrameFeatures(const Camera& camera, std::vector<cv::Point2f> pixel, std::vector<float> depth,
                std::vector<std::uint8_t> level, std::vector<float> angle,
                std::vector<Descriptor> descriptor);

  /// Those features whose flag is set, in their order.
  FrameFeatures subset(const std::vector<char>& keep) const;

  int size() const { return static_cast<int>(pixel.size()); }
  /// What they hold on the heap, bytes.
  std::size_t memory() const;

  /// Moves every pixel to where it would have been seen at the middle row's moment by a camera of
  /// that velocity, and its depth to what it was then (see at_middle_row). Replaces an earlier
  /// correction.
  void correct_rolling_shutter(const Camera& camera, const Vector6d& velocity);

  /// Features within `radius` pixels of `centre` in a square, on levels [lowest, highest].
  /// Appended to `out`, which is cleared first.
  void find(const cv::Point2f& centre, float radius, int lowest_level, int highest_level,
            std::vector<int>& out) const;

  /// Depth as the virtual right camera's u: u - fx * baseline / depth.
  double right_u(int i, const Camera& camera) const {
    return pixel[static_cast<std::size_t>(i)].x -
           camera.fx * camera.baseline / depth[static_cast<std::size_t>(i)];
  }

  std::vector<cv::Point2f> pixel;       ///< undistorted pixels, corrected for the rolling shutter
  std::vector<cv::Point2f> seen_pixel;  ///< undistorted pixels, not corrected
  std::vector<cv::Point2f> raw_pixel;   ///< as seen through the lens
  std::vector<float> depth;             ///< metres, corrected likewise; 0 where unknown
  std::vector<float> seen_depth;        ///< metres, not corrected
  std::vector<std::uint8_t> level;      ///< pyramid level
  std::vector<float> angle;             ///< degrees, 0..360
  std::vector<Descriptor> descriptor;

 private:
  void build_grid();

  // Counting-sort grid over the image, undistorted positions beyond it in the border cells.
  static constexpr int cell = 10;  // pixels
  int columns_ = 0, rows_ = 0;
  std::vector<std::int32_t> cell_start_;
  std::vector<std::int32_t> cell_members_;
};

}  // namespace dkp_slam

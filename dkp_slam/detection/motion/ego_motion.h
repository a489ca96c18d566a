#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

/// Pixels and frames are those of images 640 wide at 30 Hz; the estimator scales them to its camera
/// (see SensorScale).
struct EgoMotionOptions {
  /// Pixels of the half-size image, 320 wide; each block of this size gives its best corner. Even
  /// spread: the room keeps its say beside a person in a checked shirt. 16 gives up to 300 at
  /// 640 x 480.
  int block = 16;
  float min_quality = 0.003F;  ///< least response of a corner, as a share of the image's best
  /// Pixels of the full image that a static point may miss its predicted place by. Flow at half
  /// size is good to about half a pixel.
  double inlier_pixels = 1.5;
  /// Below this share of inliers the motion that continues the last one is not trusted and RANSAC
  /// looks for another.
  double min_inlier_share = 0.5;
  /// How much the camera's motion usually changes from one frame to the next (metres, radians),
  /// weighed like one point that misses by a pixel: settles what the points leave open. A turn
  /// with a shift can look like a moving object before a still wall.
  double usual_shift = 0.01;
  double usual_turn = 0.005;
  int min_points = 12;  ///< fewer matches with depth give no motion

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

struct EgoMotion {
  Se3 current_from_previous;
  double inlier_share = 0.0;  ///< by weight
  bool valid = false;
};

/// Motion of the camera from one frame to the next: corners, pyramidal LK flow, depth of the
/// previous frame, robust least squares on the reprojection error. Places that have stood still
/// weigh most, and the motion that continues the last one comes first, since people can fill half
/// of the image and outvote the room (algorithm.md, §3.5).
class EgoMotionEstimator {
 public:
  explicit EgoMotionEstimator(const Camera& camera, const EgoMotionOptions& options = {});

  /// `grey` and `depth` (metres) of the newest frame, full size. `trust` (CV_32FC1, 0 to 1, any
  /// size) weighs each place of the frame before: 0 what moved, 1 what has long stood still. The
  /// first call gives no motion.
  EgoMotion update(const cv::Mat& grey, const cv::Mat& depth, const cv::Mat& trust);

 private:
  struct Match {
    Eigen::Vector3d point;  ///< camera frame of the previous frame, metres
    Eigen::Vector2d pixel;  ///< in the current frame, undistorted, full size
    double weight = 1.0;
  };

  std::vector<cv::Point2f> corners() const;
  std::vector<Match> track(const std::vector<cv::Mat>& pyramid, const cv::Mat& trust) const;
  EgoMotion solve(const std::vector<Match>& matches) const;
  /// `expected`: the motion that it should be near, or null.
  Se3 refine(const std::vector<Match>& matches, const Se3& start, const Se3* expected, double scale,
             int iterations) const;
  double inlier_share(const std::vector<Match>& matches, const Se3& motion) const;

  Camera camera_;
  EgoMotionOptions options_;  // scaled to the camera
  int shrink_;                // pixels of the image in one of the small one, along a side
  int depth_reach_;           // pixels within which depth must not jump
  std::vector<cv::Mat> previous_pyramid_;
  cv::Mat previous_small_, previous_depth_;
  Se3 last_motion_;
};

}  // namespace dkp_slam

#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/coarse_rotation.h"
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
  /// Below this share of inliers what settles near the expected motion is not trusted, and another
  /// start is tried.
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
  Se3 current_from_previous;  ///< from middle row to middle row
  /// Tangents (translation, rotation) per second at the moments of the frame before and of the
  /// newest one, of a motion that changes evenly.
  Vector6d previous_velocity = Vector6d::Zero(), velocity = Vector6d::Zero();
  double inlier_share = 0.0;  ///< by weight
  bool valid = false;
};

/// Motion of the camera from one frame to the next: corners, pyramidal LK flow that starts from the
/// turn of small blurred images, depth of the previous frame, robust least squares on the
/// reprojection error, in which every point has the moments of its rows (a hand changes a turn by
/// 1.5 degrees from frame to frame: 10 px between the first row and the last). Places that have
/// stood still weigh most. People can fill half of the image and outvote the room (algorithm.md,
/// §3.5), so what is found is the most likely of a motion that continues the last one, by as much
/// as that is sure: not the one that most points agree on.
class EgoMotionEstimator {
 public:
  explicit EgoMotionEstimator(const Camera& camera, const EgoMotionOptions& options = {});

  /// `grey` and `depth` (metres) of the newest frame, full size. `trust` (CV_32FC1, 0 to 1, any
  /// size) weighs each place of the frame before: 0 what moved, 1 what has long stood still.
  /// `seconds` since then; 0 or less: unknown. The first call gives no motion.
  EgoMotion update(const cv::Mat& grey, const cv::Mat& depth, const cv::Mat& trust, double seconds);

 private:
  struct Match {
    Eigen::Vector3d point;  ///< camera frame of the previous frame, metres
    Eigen::Vector2d pixel;  ///< in the current frame, undistorted, full size
    double weight = 1.0;
    // The match's own motion is the frames', and of that so many parts more, and so many parts of
    // what it has changed by since the frames before.
    double of_motion = 0.0, of_change = 0.0;
  };

  void expect(double seconds);
  /// How much less sure the expected motion is than it usually is from frame to frame.
  double doubt() const;
  /// Gives the motion its velocities, and is what the next one continues.
  void go_on_from(EgoMotion& motion);
  std::vector<cv::Point2f> corners() const;
  std::vector<cv::Point2f> turned(const std::vector<cv::Point2f>& corners) const;
  void set_moments(Match& match, float previous_row, float current_row) const;
  std::vector<Match> track(const std::vector<cv::Mat>& pyramid, const cv::Mat& trust) const;
  EgoMotion solve(const std::vector<Match>& matches) const;
  Se3 motion_of(const Match& match, const Se3& motion, const Vector6d& tangent) const;
  /// From coarse to fine, from a kernel `widest` pixels wide on.
  Se3 settle(const std::vector<Match>& matches, Se3 start, double widest) const;
  Se3 refine(const std::vector<Match>& matches, const Se3& start, double scale,
             int iterations) const;
  /// Sigmas by which a motion differs from the expected one (metres, radians).
  Vector6d usual_change() const;
  /// Pixels; the largest number there is for a point that would be behind the camera. `tangent`: of
  /// the motion.
  double squared_miss(const Match& match, const Se3& motion, const Vector6d& tangent) const;
  /// Minus the log of how likely a motion is, in points that do not agree.
  double cost(const std::vector<Match>& matches, const Se3& motion) const;
  double inlier_share(const std::vector<Match>& matches, const Se3& motion) const;

  Camera camera_;
  EgoMotionOptions options_;  // scaled to the camera
  int shrink_;                // pixels of the image in one of the small one, along a side
  int depth_reach_;           // pixels within which depth must not jump
  std::vector<cv::Mat> previous_pyramid_;
  cv::Mat previous_small_, previous_depth_;
  CoarseRotation coarse_rotation_;
  std::optional<Eigen::Quaterniond> turn_;  // of the newest frame from the one before
  double seconds_ = 0.0;                    // between these, 0 where unknown
  double last_seconds_ = 0.0;               // between the ones before, 0 where no motion was found
  Vector6d last_velocity_ = Vector6d::Zero();  // per second
  Se3 expected_;                               // what continues it
  double last_share_ = 1.0;                    // of inliers, of the motion found last
};

}  // namespace dkp_slam

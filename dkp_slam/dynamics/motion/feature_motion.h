#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/flow.h"
#include "dkp_slam/dynamics/motion/motion_check.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/coarse_rotation.h"

namespace dkp_slam {

class OptionList;

struct FeatureMotionOptions {
  FlowOptions flow;
  MotionOptions motion;
  /// Where the motion of the frame before is not known (a start, a view that was all people), the
  /// flow starts from the camera's turn as small blurred images tell it; else from nothing.
  bool coarse_rotation = true;
  /// The long baseline, seconds: a person who sways at 5 cm/s a metre away moves 1 px from one
  /// frame to the next (the short baseline), which is noise, and 3 px in this time.
  double long_baseline = 0.13;
  /// Colour and depth of one frame are up to this share of a frame interval apart (20 of 33 ms with
  /// a freiburg1 camera): where there is an edge within that much of the flow, depth may be of
  /// either side.
  double depth_lag = 0.6;
  double min_lag_pixels = 2.0;  ///< and at least this near: depth images are that ragged at edges
  double max_lag_pixels = 8.0;  ///< and no farther than this, or everything has two depths
  int min_low_points = 30;      ///< fewer outside the boxes: all points give the ego-motion
  /// Features outside boxes from which the ego-motion is measured; with fewer, what lies on the
  /// static planes in boxes helps.
  int enough_outside = 150;
  /// Features in boxes that no mask held in the frame before are, as a rule, of the room, while
  /// outside the boxes may be a corner of the image that tells little. What was measured there is
  /// refined with those that are off by no more than this, pixels; 0: with none.
  double unmasked_distance = 3.0;
  /// Sigma of what one feature tells about the ego-motion, pixels. Several times the noise of its
  /// flow: blur, rows read one after the other and depth put near ones off together, so that many
  /// in a corner tell little more than a few.
  double feature_sigma = 4.0;
  /// Features that are followed outside the boxes of what moves by itself, evenly spread; others
  /// only where some of these move. Flow takes most of removal's time. 0: all of them.
  int followed_outside = 300;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// What flow says about the features of the newest frame. Vectors run parallel to the features.
struct FeatureMotion {
  FlowResult tracks;                             ///< into the frame before, raw pixels
  std::vector<std::uint8_t> followed;            ///< 0 where no flow was looked for
  std::vector<cv::Point2f> seen_now, seen_then;  ///< undistorted pixels
  std::vector<cv::Point2f> now, then;            ///< the same, as a global shutter would see them
  std::optional<CameraMotion> camera_motion;
  bool from_low_points = false;  ///< camera_motion rests on what lies outside the boxes alone
  std::vector<float> residual;   ///< pixels off the static prediction, NaN where unknown
  /// Sigma of the static prediction per axis for what the ego-motion is not sure of, pixels.
  std::vector<float> prediction_sigma;
  std::vector<float> long_residual;  ///< the same over the long baseline
};

/// Follows features over recent frames and compares them with a static world.
class FeatureMotionEstimator {
 public:
  FeatureMotionEstimator(const Camera& camera, const FeatureMotionOptions& options)
      : camera_(camera), options_(options), flow_(options.flow), coarse_rotation_(camera) {}

  /// Takes the newest frame and tracks its features (raw pixels) one frame back.
  /// Starts where the camera's motion would take them, were they static: its last one, else its
  /// turn. `hidden`: boxes of what may move by itself. Only features flagged `wanted` are followed,
  /// all of them where it is empty.
  FeatureMotion track(const cv::Mat& grey, const cv::Mat& depth,
                      const std::vector<cv::Point2f>& points, const std::vector<cv::Rect2f>& hidden,
                      const std::vector<std::uint8_t>& wanted, double time);
  /// The camera's motion into the newest frame from the one before, as far as it is known:
  /// measured, else that of the frame before, else none.
  Se3 current_from_previous() const;
  /// Fills camera_motion from the features flagged low, and `residual`.
  void measure_ego_motion(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                          const std::vector<std::uint8_t>& low, std::uint64_t seed,
                          FeatureMotion& motion);
  /// The same from the features flagged `support`; what was measured before stays, unless half of
  /// them, and twice as many as before, agree with the motion that they tell. Whether it was
  /// replaced.
  bool measure_ego_motion_anew(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                               const std::vector<std::uint8_t>& support, std::uint64_t seed,
                               FeatureMotion& motion);
  /// Refines the ego-motion by the features flagged `support` and those flagged `more`; what was
  /// measured before stays where fewer of the support agree then. Whether it was refined.
  bool refine_ego_motion(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                         const std::vector<std::uint8_t>& support,
                         const std::vector<std::uint8_t>& more, FeatureMotion& motion);
  /// Follows those of the `wanted` features that `track` left out, after the ego-motion, with their
  /// residuals.
  void follow_more(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                   const std::vector<std::uint8_t>& wanted, FeatureMotion& motion) const;
  /// Flow of other points of the newest frame, with their residuals off `camera_motion`, its
  /// ego-motion.
  FeatureMotion measure(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                        const std::optional<CameraMotion>& camera_motion) const;

  /// Fills `prediction_sigma` of the features that were tracked; last, as the ego-motion may be
  /// measured anew.
  void fill_prediction_sigma(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                             FeatureMotion& motion) const;

  /// Fills `long_residual` of the features flagged `wanted` that have a depth.
  void look_back(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                 const std::vector<std::uint8_t>& wanted, FeatureMotion& motion) const;

 private:
  struct Agreement {
    int followed = 0, agree = 0;  ///< features
  };
  struct Step {
    double time = 0.0;
    std::optional<Se3> previous_from_this;
  };
  std::optional<ExpectedMotion> expect() const;
  bool could_be_carried(const Se3& motion) const;
  std::vector<cv::Point2f> predict(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                                   const std::vector<cv::Point2f>& flat) const;
  std::vector<MotionPoint> motion_points(const cv::Mat& depth,
                                         const std::vector<cv::Point2f>& points,
                                         const std::vector<std::uint8_t>& low,
                                         FeatureMotion& motion) const;
  FeatureMotion unmeasured(const cv::Mat& depth, const std::vector<cv::Point2f>& points) const;
  bool follow(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
              const std::vector<std::uint8_t>& wanted, FeatureMotion& motion) const;
  Agreement agreement(const std::vector<std::uint8_t>& support, const FeatureMotion& motion) const;
  void fill_residuals(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                      FeatureMotion& motion) const;
  Vector6d velocity_at(std::size_t step) const;
  std::vector<cv::Point2f> straight(const std::vector<cv::Point2f>& raw,
                                    const std::vector<cv::Point2f>& seen, const cv::Mat& depth,
                                    const std::vector<cv::Point2f>& depth_from,
                                    std::size_t step) const;
  double residual_at(const cv::Mat& depth, const cv::Point2f& raw, const cv::Point2f& now,
                     const cv::Point2f& then, const cv::Point2f& flow,
                     const Se3& then_from_now) const;

  Camera camera_;
  FeatureMotionOptions options_;
  BackwardFlow flow_;
  CoarseRotation coarse_rotation_;
  std::deque<Step> steps_;  // newest first, parallel to the flow's frames
};

}  // namespace dkp_slam

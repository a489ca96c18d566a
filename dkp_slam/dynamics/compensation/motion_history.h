#pragma once

#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/dynamics/motion/flow.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

/// Seconds by which two time stamps of one moment may differ: those in text files are rounded.
inline constexpr double same_time = 1e-4;

struct MotionHistoryOptions {
  /// What lies in a box within so many metres of the object's depth belongs to it: half the depth
  /// of a person with an arm stretched out.
  float depth_reach = 0.35F;
  /// A near layer of depth that fills less than this share of a box's central half is something
  /// thin in front of the object.
  double least_layer_share = 0.2;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// How everything in view moved over the last moments, to carry what was seen in an earlier image
/// to now: by the median flow of what lies in the box at the object's depth, and where there is too
/// little of it, by the ego-motion and the object's own last velocity.
class MotionHistory {
 public:
  /// Remembers `seconds`.
  MotionHistory(const Camera& camera, const MotionHistoryOptions& options, double seconds)
      : camera_(camera), options_(options), seconds_(seconds) {}

  /// Takes the newest frame: its time (seconds), depth, features (raw pixels), and their flow into
  /// the frame before.
  void add(double time, const DepthView& view, const std::vector<cv::Point2f>& points,
           const FlowResult& tracks);
  /// Lets go of what is only asked for about images (seconds) before this one, as nothing is once
  /// this one is answered: a second of depth takes 5 MB.
  void forget_before(double time);
  /// Of the newest frame.
  void set_ego_motion(const Se3& current_from_previous);

  /// Something of an earlier image as it is now.
  struct Carried {
    cv::Rect2f box;        ///< pixels, not clipped to the image
    cv::Point2f shift;     ///< pixels that its centre moved since
    cv::Point2f velocity;  ///< pixels a second, over the last step
    float depth = 0.0F;    ///< metres, of the object; 0 when unknown
    ObjectMask mask;       ///< the silhouette as it was; empty for none
  };
  /// Carries a box (pixels) of the image at `time`, with its silhouette (Detection::mask, may be
  /// empty), to the newest frame. Nothing when that is longer ago than is remembered.
  std::optional<Carried> carry(const cv::Rect2f& box, const cv::Mat& silhouette, double time) const;

 private:
  struct Step {
    double time = 0.0;
    cv::Mat depth;                               // of the view; see `pack`
    std::vector<cv::Point2f> now, before;        // features that were tracked from the frame before
    std::vector<float> depth_now, depth_before;  // theirs, metres, 0 where unknown
    std::optional<Se3> current_from_previous;
  };
  struct Motion {
    cv::Point2f shift;
    float depth = 0.0F;
  };
  DepthView view_of(const Step& step) const;
  float object_depth(const DepthView& view, const cv::Rect2f& box) const;
  std::optional<Motion> measured(const Step& step, const cv::Rect2f& box, float depth) const;
  cv::Point2f static_shift(const Step& step, const cv::Point2f& centre, float depth) const;
  void advance(const Step& before, const Step& step, float share, cv::Point2f& own_velocity,
               Carried& carried) const;

  Camera camera_;
  MotionHistoryOptions options_;
  double seconds_;
  cv::Mat rays_;            // of all views
  std::deque<Step> steps_;  // oldest first
};

/// A box moved by `shift` and scaled about its centre, as what comes nearer grows: from the depth
/// before to the one now, metres; only moved while either is unknown (0).
cv::Rect2f moved_box(const cv::Rect2f& box, const cv::Point2f& shift, float depth_before,
                     float depth_now);

}  // namespace dkp_slam

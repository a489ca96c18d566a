#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/clustering.h"
#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"

namespace dkp_slam {

class OptionList;

struct MovingSurfaceOptions {
  /// Residuals by which a feature counts as moving or still when surfaces are judged, pixels, over
  /// the short baseline (one frame) and the long one. Between them it says nothing.
  float moving_short = 1.5F;
  float moving_long = 2.5F;
  float still_long = 1.2F;
  /// But moving only above so many sigma of the static points' residuals.
  float noise_factor = 4.0F;
  /// A surface outside all boxes that is proved to move becomes an object by itself when it takes
  /// at least this share of the image; smaller ones lose their points one by one.
  double least_share = 0.01;
  double least_seconds = 0.09;  ///< keeps moving so long: one bad frame makes no person
  int least_features = 10;      ///< and bears so many features that move

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Judges surfaces by the features on them, and finds people whom no detector sees: surfaces that
/// are proved to move and that no object holds.
class MovingSurfaces {
 public:
  explicit MovingSurfaces(const MovingSurfaceOptions& options) : options_(options) {}

  /// Whether enough features move for a look at the surfaces to be worth its time.
  bool worth_a_look(const FeatureMotion& motion) const;
  /// Counts moving and still features (raw pixels) on every surface.
  void judge(const std::vector<cv::Point2f>& points, const FeatureMotion& motion,
             SegmentMap& surfaces) const;
  /// Masks of judged surfaces that have kept moving for long enough and lie mostly outside the
  /// masks `held`. `time` of the frame in seconds. Once a frame, in order.
  std::vector<ObjectMask> find(const SegmentMap& surfaces, const std::vector<ObjectMask>& held,
                               double time);

 private:
  /// A surface that moves, and since when (seconds).
  struct Suspect {
    ObjectMask mask;
    double since = 0.0;
  };

  MovingSurfaceOptions options_;
  std::vector<Suspect> suspects_;
};

}  // namespace dkp_slam

#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/dynamics/removal/feature_dynamics.h"
#include "dkp_slam/dynamics/removal/regions.h"

namespace dkp_slam {

/// What a rule may look at. Vectors run parallel to the features.
struct RemovalInput {
  const std::vector<cv::Point2f>& points;     ///< raw pixels
  const std::vector<ObjectRegions>& objects;  ///< of this frame
  const cv::Mat& labels;                      ///< CV_8UC1, image size: i + 1 in objects[i]'s mask
  const cv::Mat& depth;                       ///< CV_32FC1, image size, metres, 0 where unknown
  const FeatureMotion& motion;
  bool bring_back = true;  ///< those that move least, where few are static
};

/// A rule that tells static features from dynamic ones (paper §3.5).
class FeatureClassifier {
 public:
  virtual ~FeatureClassifier() = default;
  virtual std::string name() const = 0;
  /// Sets `is_static` of every feature and what the rule measured on the way. Region, `tracked` and
  /// `motion_residual` of the features are known.
  virtual void classify(const RemovalInput& input,
                        std::vector<FeatureDynamics>& features) const = 0;
  /// Whether it may be asked about some of an image's features, without the others.
  virtual bool judges_one_by_one() const { return false; }
  /// CV_8UC1, image size: not 0 where nothing is static before the rule has looked at it; empty
  /// without objects.
  virtual cv::Mat doubtful(const RemovalInput& input) const;
};

}  // namespace dkp_slam

#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/compensation/dynamic_object.h"
#include "dkp_slam/dynamics/removal/feature_dynamics.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Result of the dynamics room for one frame.
struct FrameDynamics {
  std::vector<DynamicObject> objects;
  cv::Mat mask;  ///< CV_8UC1, image size, 255 in the high region; empty when there is no object
  std::vector<FeatureDynamics> features;  ///< one per keypoint, in their order
  /// CV_8UC1, image size, not 0 where a feature that was not among them may be dynamic; empty when
  /// there is no object.
  cv::Mat doubtful;
  /// Camera at this frame from camera at the frame before, from the flow of what lies outside the
  /// boxes; nothing when it could not be told (and in the modes that do not look).
  std::optional<Se3> current_from_previous;
  double clustering_ms = 0.0;
  double removal_ms = 0.0;  ///< flow, fundamental matrix, motion and classification
};

}  // namespace dkp_slam

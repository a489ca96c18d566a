#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// How dynamic points are removed; the ablation of the paper's Table 6 and ours.
enum class DynamicsMode {
  off,       ///< nothing is removed: the plain RGB-D SLAM baseline
  d,         ///< all features in boxes go; missed detections are compensated
  dk,        ///< all features in the clustered masks go
  dkp,       ///< the paper: region weight times epipolar distance (Algorithm 2)
  dkp_plus,  ///< ours: algorithm.md, "Beyond that"
};

/// Where a feature lies (paper §3.5 step 1).
enum class Region : std::uint8_t {
  low,         ///< outside every box
  suspicious,  ///< in a box, outside its mask
  high,        ///< in a mask
};

/// What the dynamic point removal found about one feature of the current frame.
struct FeatureDynamics {
  Region region = Region::low;
  bool is_static = true;
  bool tracked = false;  ///< optical flow found it in the previous frame, forward and backward
  float weight = 1.0F;   ///< W, Eq. 6; told in mode dkp alone
  /// D of Eq. 5, pixels; NaN where the feature was not tracked or there was no fundamental matrix,
  /// and in all modes but dkp.
  float epipolar_distance = std::numeric_limits<float>::quiet_NaN();
  /// Distance, pixels, from where a static point would have moved; NaN where it cannot be told.
  float motion_residual = std::numeric_limits<float>::quiet_NaN();
};

/// One movable object of the current frame.
struct DynamicObject {
  int id = 0;  ///< the same from frame to frame
  int class_id = -1;
  cv::Rect2f box;              ///< pixels
  float weight = 10.0F;        ///< W of its class
  float score = 0.0F;          ///< of its newest detection
  bool compensated = false;    ///< carried over from earlier frames, not detected in this one
  double last_detected = 0.0;  ///< seconds, time stamp of its newest detection
  float mean_depth = 0.0F;     ///< T, metres, over the mask; 0 when unknown
  float mask_share = 0.0F;     ///< R, mask pixels over box pixels with known depth
};

/// Result of the dynamics room for one frame.
struct FrameDynamics {
  std::vector<DynamicObject> objects;
  cv::Mat mask;  ///< CV_8UC1, image size, 255 in the high region; empty when there is no object
  std::vector<FeatureDynamics> features;  ///< one per keypoint, in their order
  /// Camera at this frame from camera at the frame before, from the flow of what lies outside the
  /// boxes; nothing when it could not be told (and in the modes that do not look).
  std::optional<Se3> current_from_previous;
  double clustering_ms = 0.0;
  double removal_ms = 0.0;  ///< flow, fundamental matrix, motion and classification
};

}  // namespace dkp_slam

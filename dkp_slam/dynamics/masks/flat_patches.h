#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/segments.h"
#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {

class OptionList;

struct FlatPatchOptions {
  /// Half thickness of a flat patch, metres, at depth z: constant + quadratic * z^2, about 3 sigma
  /// of a Kinect. Clothes are not that flat, monitors are.
  double thickness_constant = 0.003;
  double thickness_quadratic = 0.002;
  /// Beyond this depth, metres, the noise is as large as a body's relief and nothing can be told.
  double max_depth = 2.0;
  double min_area = 0.02;  ///< square metres facing the camera: a smaller patch may be a sleeve
  /// Most pixels that a patch may hold at twice the thickness, times its own. A screen ends
  /// sharply, while the band that two parallel planes cut out of clothes widens by half and more,
  /// and out of a smooth round body by the square root of 1.5. How much it bulges tells little: a
  /// Kinect bends a screen as much as a back.
  double max_widening = 1.18;
  int iterations = 150;
  int max_per_segment = 8;  ///< that are looked at, flat or not

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Flat patches in the segments, 255 in a CV_8UC1 of the view's size: a monitor at the same depth
/// as the person in front of it is one connected surface with that person, and this is how to part
/// them. `focal_length` of the image in pixels.
cv::Mat find_flat_patches(const DepthView& view, const SegmentMap& map, double focal_length,
                          const FlatPatchOptions& options, std::uint64_t seed);

}  // namespace dkp_slam

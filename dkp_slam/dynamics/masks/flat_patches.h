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
  double min_area = 0.03;  ///< square metres facing the camera: a smaller patch may be a sleeve
  /// Most that a patch may bulge from its middle to its edge, share of its half thickness: a band
  /// of a rounded body between two parallel planes bulges by twice the half thickness.
  double max_bulge = 1.0;
  /// Above this bulge (a Kinect bends a monitor by as much) the patch must end sharply: at twice
  /// the thickness it holds at most `max_widening` times its pixels, while a body's band widens.
  double doubtful_bulge = 0.5;
  double max_widening = 1.08;
  int iterations = 60;
  int max_per_segment = 2;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Flat patches in the segments, 255 in a CV_8UC1 of the view's size: a monitor at the same depth
/// as the person in front of it is one connected surface with that person, and this is how to part
/// them. `focal_length` of the image in pixels.
cv::Mat find_flat_patches(const DepthView& view, const SegmentMap& map, double focal_length,
                          const FlatPatchOptions& options, std::uint64_t seed);

}  // namespace dkp_slam

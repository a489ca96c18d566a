#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {

class OptionList;

struct SegmentOptions {
  /// Depth step between neighbouring pixels that still belong to one surface, metres at depth z:
  /// constant + quadratic * z^2, which grows as a Kinect's noise and rounding do.
  double step_constant = 0.010;
  double step_quadratic = 0.005;
  /// A surface is flat when its points lie off their best plane by less than this (root mean
  /// square, constant + quadratic * z^2, metres): a monitor or a wall, not a body.
  double flat_constant = 0.010;
  double flat_quadratic = 0.0012;
  int flat_area = 300;  ///< pixels of the view: smaller pieces of a body may well be flat
  /// Square metres facing the camera: a flat surface larger than this is a thing, even where the
  /// features at the outline of who stands before it make it seem to move.
  double thing_area = 0.08;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A piece of surface without a step in depth.
struct Segment {
  int area = 0;             ///< pixels of the view
  cv::Rect box;             ///< pixels of the view
  float mean_depth = 0.0F;  ///< metres
  bool flat = false;        ///< lies on a plane of its own
  bool large = false;       ///< flat, and too large to be part of a person
  int moving = 0;           ///< features on it that moved against the static world
  int surely_moving = 0;    ///< of those that moved: by more than the ego-motion may be off there
  int still = 0;            ///< features on it that did not move

  /// Enough features say so, and few say otherwise.
  bool proved_moving() const { return proved(moving); }
  /// The same by those that moved for sure.
  bool proved_surely_moving() const { return proved(surely_moving); }
  bool proved_still() const { return still >= 4 && still > 3 * moving; }
  /// No part of a person.
  bool thing() const { return large || (flat && !proved_moving()); }

 private:
  bool proved(int moved) const { return moved >= 4 && moved > 2 * still; }
};

struct SegmentMap {
  cv::Mat labels;  ///< CV_32SC1, view size: 0 for none, i + 1 for segments[i]
  std::vector<Segment> segments;
};

/// Connected surfaces of the view outside `excluded` (CV_8UC1, view size, anything but 0; may be
/// empty).
SegmentMap segment_surfaces(const DepthView& view, const cv::Mat& excluded,
                            const SegmentOptions& options);

/// Index of the segment at, or within 2 pixels of, a pixel of the view; the nearest in depth to the
/// camera where several are; -1 for none.
int segment_near(const SegmentMap& map, int x, int y);

}  // namespace dkp_slam

#pragma once

#include <vector>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A smooth path near poses at equal distances in time: a uniform cubic B-spline, of positions and
/// (normalised) of quaternions, which is right for poses that lie close together.
class PoseSpline {
 public:
  /// `knots`: the first at 0 s, one every `interval` seconds, at least one. Before and after them
  /// the path rests, or with `closed` it begins anew one interval after the last knot.
  PoseSpline(std::vector<Se3> knots, double interval, bool closed = false);

  Se3 at(double time) const;

 private:
  const Se3& knot(long index) const;

  std::vector<Se3> knots_;
  double interval_;
  bool closed_;
};

}  // namespace dkp_slam

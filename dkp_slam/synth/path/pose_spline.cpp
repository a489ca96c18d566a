#include "dkp_slam/synth/path/pose_spline.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace dkp_slam {

PoseSpline::PoseSpline(std::vector<Se3> knots, double interval, bool closed)
    : knots_(std::move(knots)), interval_(interval), closed_(closed) {
  assert(!knots_.empty() && interval_ > 0.0);
}

const Se3& PoseSpline::knot(long index) const {
  const auto count = static_cast<long>(knots_.size());
  if (closed_) {
    index = (index % count + count) % count;
  } else {
    index = std::clamp(index, 0L, count - 1);
  }
  return knots_[static_cast<std::size_t>(index)];
}

Se3 PoseSpline::at(double time) const {
  const double place = time / interval_;
  const double whole = std::floor(place);
  const double u = place - whole, v = 1.0 - u;
  const std::array<double, 4> weights = {
      v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
      (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector4d rotation = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Se3& near = knot(static_cast<long>(whole) + static_cast<long>(i) - 1);
    Eigen::Vector4d q = near.rotation.coeffs();
    if (q.dot(rotation) < 0.0) q = -q;  // q and -q are the same rotation
    position += weights[i] * near.translation;
    rotation += weights[i] * q;
  }
  return {Eigen::Quaterniond(rotation).normalized(), position};
}

}  // namespace dkp_slam

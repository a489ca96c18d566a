#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// A camera's motion over a second or two: a uniform cubic B-spline of (rotation vector, position)
/// of the camera in a frame of reference that is never turned away from it by half a turn.
class MotionSpline {
 public:
  using Controls = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  /// What four neighbouring controls make of a moment.
  struct Moment {
    int first = 0;                 ///< of the four
    std::array<double, 4> weight;  ///< of their values
    std::array<double, 4> rate;    ///< 1/second, of the derivative by time
  };

  MotionSpline() = default;
  /// From `begin` to `end`, seconds, with a control every `step` seconds.
  MotionSpline(double begin, double end, double step)
      : begin_(begin),
        step_(step),
        controls(Controls::Zero(6, static_cast<int>(std::ceil((end - begin) / step)) + 3)) {}

  int size() const { return static_cast<int>(controls.cols()); }

  /// Beyond the ends the last piece goes on.
  Moment moment(double time) const {
    const double place = (time - begin_) / step_;
    const int first = std::clamp(static_cast<int>(std::floor(place)), 0, size() - 4);
    const double u = place - first, v = 1.0 - u;
    constexpr double sixth = 1.0 / 6.0;
    return {first,
            {sixth * v * v * v, sixth * (3.0 * u * u * u - 6.0 * u * u + 4.0),
             sixth * (3.0 * v * v * v - 6.0 * v * v + 4.0), sixth * u * u * u},
            {-0.5 * v * v / step_, (1.5 * u * u - 2.0 * u) / step_, (2.0 * v - 1.5 * v * v) / step_,
             0.5 * u * u / step_}};
  }
  Vector6d value(const Moment& m) const {
    return controls.middleCols<4>(m.first) * Eigen::Map<const Eigen::Vector4d>(m.weight.data());
  }
  Vector6d rate(const Moment& m) const {
    return controls.middleCols<4>(m.first) * Eigen::Map<const Eigen::Vector4d>(m.rate.data());
  }

 private:
  double begin_ = 0.0, step_ = 1.0;

 public:
  Controls controls;  ///< rotation vector, position (metres)
};

}  // namespace dkp_slam

#include "dkp_slam/calibration/sighting_terms.h"

#include <ceres/jet.h>
#include <ceres/rotation.h>

namespace dkp_slam {
namespace {

constexpr double nearest = 0.05;  // metres along z: what is nearer makes no usable projection

/// The landmark in the camera's frame: R^T (X - p).
template <class T>
std::array<T, 3> in_camera(const T* pose, const T* point) {
  const T back[3] = {-pose[0], -pose[1], -pose[2]};
  const T away[3] = {point[0] - pose[3], point[1] - pose[4], point[2] - pose[5]};
  std::array<T, 3> out;
  ceres::AngleAxisRotatePoint(back, away, out.data());
  return out;
}

/// Raw pixel, `lens` as in Parameters from fx on.
template <class T, class L>
std::array<T, 2> raw_pixel(const std::array<T, 3>& p, const L* lens) {
  const T x = p[0] / p[2], y = p[1] / p[2];
  const T r2 = x * x + y * y;
  const L *f = lens, *c = lens + 2, *d = lens + 4;
  const T radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const T dx = 2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x);
  const T dy = d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y;
  return {f[0] * (x * radial + dx) + c[0], f[1] * (y * radial + dy) + c[1]};
}

template <class T, class L>
bool pixel_residual(const T* pose, const T* point, const L* lens, const TimedSighting& seen, T* r) {
  const std::array<T, 3> p = in_camera(pose, point);
  if (p[2] < nearest) return false;
  const std::array<T, 2> place = raw_pixel(p, lens);
  r[0] = place[0] - seen.pixel.x();
  r[1] = place[1] - seen.pixel.y();
  return true;
}

template <class T, class L>
bool depth_residual(const T* pose, const T* point, const L* lens, double bias, double distortion,
                    const TimedSighting& seen, T* r) {
  const std::array<T, 3> p = in_camera(pose, point);
  if (p[2] < nearest) return false;
  const std::array<T, 2> place = raw_pixel(p, lens);
  const DepthPatch& d = seen.depth;
  const T measured =
      d.inverse + d.slope.x() * (place[0] - d.pixel.x()) + d.slope.y() * (place[1] - d.pixel.y());
  // What the sensor must have said is compared with what it said. The other way round, by
  // correcting what it said, a large bias would make all errors small.
  const T sensed = p[2] - bias;
  if (sensed < nearest) return false;
  r[0] = 1.0 / sensed - distortion - measured;
  return true;
}

/// Fills everything but the derivatives by time-like parameters. `residual(pose, point, lens, r)`.
template <int Rows, bool Lens, class Residual>
void differentiate(const Vector6d& pose, const Eigen::Vector3d& point, const Parameters& parameters,
                   const Residual& residual, ErrorTerm<Rows>& term) {
  constexpr int lens_size = Lens ? lens_parameters : 0;
  using Jet = ceres::Jet<double, 9 + lens_size>;
  Jet x[9], r[Rows];
  for (int i = 0; i < 9; ++i) x[i] = Jet(i < 6 ? pose[i] : point[i - 6], i);
  if constexpr (Lens) {
    Jet lens[lens_parameters];
    for (int i = 0; i < lens_parameters; ++i)
      lens[i] = Jet(parameters[first_lens_parameter + i], 9 + i);
    term.valid = residual(x, x + 6, lens, r);
  } else {
    term.valid = residual(x, x + 6, parameters.data() + first_lens_parameter, r);
  }
  if (!term.valid) return;
  term.by_parameter.setZero();
  for (int i = 0; i < Rows; ++i) {
    term.error[i] = r[i].a;
    term.by_pose.row(i) = r[i].v.template head<6>();
    term.by_point.row(i) = r[i].v.template segment<3>(6);
    if constexpr (Lens) {
      term.by_parameter.row(i).template segment<lens_parameters>(first_lens_parameter) =
          r[i].v.template tail<lens_parameters>();
    }
  }
}

template <int Rows, class Residual>
ErrorTerm<Rows> term_at(const MotionSpline& motion, double time, const Eigen::Vector3d& point,
                        const Parameters& parameters, bool lens, const Residual& residual) {
  ErrorTerm<Rows> term;
  term.moment = motion.moment(time);
  const Vector6d pose = motion.value(term.moment);
  if (lens) {
    differentiate<Rows, true>(pose, point, parameters, residual, term);
  } else {
    differentiate<Rows, false>(pose, point, parameters, residual, term);
  }
  if (term.valid) term.by_time = term.by_pose * motion.rate(term.moment);
  return term;
}

}  // namespace

ErrorTerm<2> pixel_error(const MotionSpline& motion, const Eigen::Vector3d& point,
                         const TimedSighting& seen, const Parameters& parameters, bool lens) {
  const double time = seen.time + seen.row * parameters[readout_parameter];
  auto term = term_at<2>(motion, time, point, parameters, lens,
                         [&](const auto* pose, const auto* x, const auto* l, auto* r) {
                           return pixel_residual(pose, x, l, seen, r);
                         });
  if (term.valid) term.by_parameter.col(readout_parameter) = seen.row * term.by_time;
  return term;
}

ErrorTerm<1> depth_error(const MotionSpline& motion, const Eigen::Vector3d& point,
                         const TimedSighting& seen, const Parameters& parameters, bool lens) {
  const double bias = parameters[bias_parameter];
  const double distortion = depth_distortion_of(parameters).dot(seen.depth_terms);
  const double row_delay = seen.depth_row_delay.value_or(seen.row * parameters[readout_parameter]);
  const double time = seen.depth_time + parameters[delay_parameter] + row_delay;
  auto term = term_at<1>(motion, time, point, parameters, lens,
                         [&](const auto* pose, const auto* x, const auto* l, auto* r) {
                           return depth_residual(pose, x, l, bias, distortion, seen, r);
                         });
  if (!term.valid) return term;
  if (!seen.depth_row_delay) term.by_parameter.col(readout_parameter) = seen.row * term.by_time;
  term.by_parameter.col(delay_parameter) = term.by_time;
  // By the bias of 1 / (z - bias), which is what was measured but for error and distortion.
  const double sensed = term.error[0] + seen.depth.inverse + distortion;
  term.by_parameter(0, bias_parameter) = sensed * sensed;
  term.by_parameter.middleCols<DepthDistortion::size>(depth_distortion_parameter) =
      -seen.depth_terms.transpose();
  return term;
}

}  // namespace dkp_slam

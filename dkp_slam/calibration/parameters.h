#pragma once

#include <array>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// What is sought, in this order.
enum Parameter : int {
  readout_parameter,  ///< seconds
  delay_parameter,    ///< seconds, of depth, beyond what the frames' stamps say
  bias_parameter,     ///< metres, to be added to depth as the frames hold it
  /// 1/metre, the first of the coefficients to be added to those of the depth distortion.
  depth_distortion_parameter,
  fx_parameter = depth_distortion_parameter + DepthDistortion::size,
  fy_parameter,
  cx_parameter,
  cy_parameter,
  k1_parameter,
  k2_parameter,
  p1_parameter,
  p2_parameter,
  k3_parameter,
  parameter_count
};

using Parameters = Eigen::Matrix<double, parameter_count, 1>;
using ParameterMatrix = Eigen::Matrix<double, parameter_count, parameter_count>;
using ParameterChoice = std::array<bool, parameter_count>;

constexpr int first_lens_parameter = fx_parameter;
constexpr int lens_parameters = parameter_count - first_lens_parameter;

inline Parameters parameters_of(const Camera& c) {
  const Distortion& d = c.distortion;
  Parameters p;
  p << c.readout, 0.0, 0.0, DepthDistortion::Terms::Zero(), c.fx, c.fy, c.cx, c.cy, d.k1, d.k2,
      d.p1, d.p2, d.k3;
  return p;
}

/// `camera` with the readout and the lens of `p`.
inline Camera with_parameters(Camera camera, const Parameters& p) {
  camera.readout = p[readout_parameter];
  camera.fx = p[fx_parameter];
  camera.fy = p[fy_parameter];
  camera.cx = p[cx_parameter];
  camera.cy = p[cy_parameter];
  camera.distortion = {p[k1_parameter], p[k2_parameter], p[p1_parameter], p[p2_parameter],
                       p[k3_parameter]};
  return camera;
}

/// What is to be added to the coefficients of the depth distortion.
inline DepthDistortion::Terms depth_distortion_of(const Parameters& p) {
  return p.segment<DepthDistortion::size>(depth_distortion_parameter);
}

}  // namespace dkp_slam

#include "dkp_slam/sensor/synthetic/motion.h"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

const Vector3d start(0.0, -1.05, 1.35);  // where the camera is held
const Vector3d target(0.0, 1.45, 0.95);  // what it looks at: the desk
constexpr double sphere_radius = 2.35;   // metres around the target

/// sin of `time` in `period` seconds, varied by up to a tenth by `rng`.
double wave(cv::RNG& rng, double time, double period) {
  return std::sin(2.0 * std::numbers::pi * time / (period * rng.uniform(0.9, 1.1)));
}

/// Camera axes: x right, y down, z towards `to`.
Eigen::Quaterniond look(const Vector3d& from, const Vector3d& to) {
  Eigen::Matrix3d axes;
  axes.col(2) = (to - from).normalized();
  axes.col(0) = axes.col(2).cross(Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Eigen::Quaterniond(axes);
}

/// Trembling of a hand: about 2 mm and 0.1 degrees.
Se3 tremor(cv::RNG& rng, double time) {
  Vector6d t;
  for (int i = 0; i < 6; ++i) {
    const double amplitude = i < 3 ? 0.002 : 0.0018;
    const double slow = wave(rng, time, 1.1), fast = wave(rng, time, 0.47);
    t[i] = amplitude * (slow + 0.4 * fast);
  }
  return Se3::exp(t);
}

}  // namespace

Se3 camera_pose(SyntheticMotion motion, std::uint64_t seed, double time) {
  cv::RNG rng(seed * 2 + 77);
  // Picks up speed over the first second.
  const double t = time < 1.0 ? 0.5 * time * time : time - 0.5;
  Vector3d position = start, aim = target;
  if (motion == SyntheticMotion::xyz) {
    const double x = wave(rng, t, 6.3), y = wave(rng, t, 8.9), z = wave(rng, t, 5.1);
    position += Vector3d(0.32 * x, 0.22 * y, 0.22 * z);
    // The gaze follows, so that the view shifts as in a translation.
    aim += Vector3d(0.22 * x, 0.0, 0.12 * z);
  } else if (motion == SyntheticMotion::halfsphere) {
    const double azimuth = 0.50 * wave(rng, t, 9.5);
    const double elevation = 0.17 + 0.20 * (1.0 - std::cos(2.0 * std::numbers::pi * t / 7.4));
    position = target + sphere_radius * Vector3d(std::sin(azimuth) * std::cos(elevation),
                                                 -std::cos(azimuth) * std::cos(elevation),
                                                 std::sin(elevation));
  }
  return Se3(look(position, aim), position) * tremor(rng, t);
}

}  // namespace dkp_slam

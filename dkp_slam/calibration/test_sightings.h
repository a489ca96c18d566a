#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "dkp_slam/calibration/sightings.h"

namespace dkp_slam::testing {

/// What is wrong with a camera, and how it moves.
struct World {
  double readout = 0.02, delay = 0.008, bias = 0.03;
  std::optional<double> depth_readout;  ///< nothing: as readout
  DepthDistortion distortion;
  double pixel_noise = 0.5;
  double turn = 0.15, way = 0.10;  ///< amplitudes, radians and metres
  /// Instead of both: moves evenly, metres per second.
  Eigen::Vector3d even{0.0, 0.0, 0.0};
  int frames = 180;
  unsigned seed = 1;
};

inline Camera camera_of(const World& world) {
  Camera camera;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.readout = world.readout;
  camera.depth_readout = world.depth_readout;
  return camera;
}

/// Turned to and fro and moved about, each freedom at its own pace.
inline Se3 pose_at(const World& world, double t) {
  const Eigen::Vector3d turn(std::sin(3.1 * t), std::sin(2.3 * t + 1.0), std::sin(1.7 * t + 2.0));
  const Eigen::Vector3d way(std::sin(1.3 * t), std::sin(1.9 * t + 0.5), std::sin(2.7 * t + 1.5));
  Vector6d tangent;
  tangent << world.way * way, world.turn * turn;
  if (!world.even.isZero()) tangent << world.even * (t - 103.0), Eigen::Vector3d::Zero();
  return Se3::exp(tangent);
}

/// Where a point is seen by a camera whose rows are read one after the other.
inline Eigen::Vector2d seen_pixel(const World& world, const Camera& camera,
                                  const Eigen::Vector3d& point, double time, double readout,
                                  double* depth) {
  double row = 0.0;
  Eigen::Vector2d pixel;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p = pose_at(world, time + row * readout).inverse() * point;
    pixel = camera.project(p);
    row = pixel.y() / camera.height - 0.5;
    *depth = p.z();
  }
  return pixel;
}

/// Points in space before the camera.
inline std::vector<Eigen::Vector3d> scattered_points(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i) {
    const double z = 2.0 + uniform(random);
    points.emplace_back(0.7 * z * uniform(random), 0.5 * z * uniform(random), z);
  }
  return points;
}

/// Exact sightings of points in space with noise. The path is given as the true one, with errors.
inline std::vector<SightedFrame> frames_of(const World& world) {
  const Camera camera = camera_of(world);
  std::mt19937 random(world.seed);
  std::normal_distribution<double> normal;
  const std::vector<Eigen::Vector3d> points = scattered_points(random);
  std::vector<SightedFrame> frames;
  for (int i = 0; i < world.frames; ++i) {
    SightedFrame frame;
    frame.time = 100.0 + i / 30.0;
    frame.depth_time = frame.time;
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = 0.002 * normal(random);
    frame.world_from_camera = pose_at(world, frame.time) * Se3::exp(error);
    for (std::size_t k = 0; k < points.size(); ++k) {
      double z = 0.0, later_z = 0.0;
      SeenLandmark seen;
      seen.landmark = static_cast<int>(k);
      seen.pixel = seen_pixel(world, camera, points[k], frame.time, world.readout, &z);
      if (z < 0.3 || seen.pixel.x() < 10 || seen.pixel.x() > 630 || seen.pixel.y() < 10 ||
          seen.pixel.y() > 470) {
        continue;
      }
      // Each point lies on a surface that faces the camera.
      seen.depth.pixel = seen_pixel(world, camera, points[k], frame.time + world.delay,
                                    world.depth_readout.value_or(world.readout), &later_z);
      const double noise = 0.3 * camera.depth_noise.sigma(later_z) * normal(random);
      seen.depth.inverse = 1.0 / (later_z - world.bias + noise) -
                           world.distortion.coefficients.dot(DepthDistortion::terms(
                               seen.depth.pixel, {camera.width, camera.height}));
      seen.pixel.x() += world.pixel_noise * normal(random);
      seen.pixel.y() += world.pixel_noise * normal(random);
      frame.sightings.push_back(seen);
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace dkp_slam::testing

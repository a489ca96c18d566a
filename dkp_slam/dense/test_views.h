#pragma once

#include <cmath>
#include <functional>

#include <Eigen/Geometry>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam::testing {

/// A small camera without noise or distortion.
inline Camera small_camera() {
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

/// Length of a ray (origin, direction) up to what it meets; infinite where it meets nothing.
using Scene = std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

/// Everything at z = `depth`.
inline Scene wall(double depth) {
  return [depth](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    const double t = (depth - o.z()) / d.z();
    return t > 0.0 ? t : INFINITY;
  };
}

inline Scene ball(const Eigen::Vector3d& centre, double radius) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    const Eigen::Vector3d m = o - centre;
    const double a = d.squaredNorm(), b = m.dot(d), c = m.squaredNorm() - radius * radius;
    const double root = b * b - a * c;
    return root >= 0.0 ? (-b - std::sqrt(root)) / a : INFINITY;
  };
}

inline Scene box(const Eigen::AlignedBox3d& box) {
  return [box](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    double in = 0.0, out = INFINITY;
    for (int i = 0; i < 3; ++i) {
      const double a = (box.min()[i] - o[i]) / d[i], b = (box.max()[i] - o[i]) / d[i];
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    return in < out ? in : INFINITY;
  };
}

inline Scene both(const Scene& a, const Scene& b) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    return std::min(a(o, d), b(o, d));
  };
}

/// Exact depth of a scene, each row at its own pose; grey colour.
inline RgbdFrame seen_by_rows(const Camera& camera, const Scene& scene,
                              const std::function<Se3(int row)>& world_from_camera) {
  RgbdFrame frame;
  frame.colour = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(30, 60, 90));
  frame.depth.create(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    const Se3 pose = world_from_camera(v);
    for (int u = 0; u < camera.width; ++u) {
      const auto pixel = camera.undistort({cv::Point2f(float(u), float(v))}).front();
      const Eigen::Vector3d ray = camera.unproject({pixel.x, pixel.y}, 1.0);
      const double depth = scene(pose.translation, pose.rotation * ray);
      frame.depth.at<float>(v, u) = depth < camera.max_depth ? static_cast<float>(depth) : 0.0F;
    }
  }
  return frame;
}

inline RgbdFrame seen(const Camera& camera, const Scene& scene, const Se3& world_from_camera = {}) {
  return seen_by_rows(camera, scene, [&](int) { return world_from_camera; });
}

/// The i-th of some poses around the origin that look ahead.
inline Se3 swaying(int i) {
  const double a = 0.7 * i;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.08 * std::sin(1.3 * a), Eigen::Vector3d::UnitY())),
          {0.15 * std::cos(a), 0.1 * std::sin(a), 0.05 * std::sin(0.5 * a)}};
}

}  // namespace dkp_slam::testing

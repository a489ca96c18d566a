#pragma once

#include <random>
#include <vector>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam::testing {

/// Points in front of a camera near the world's origin, and exact observations of them.
struct Scene {
  Camera camera;
  std::vector<Eigen::Vector3d> points;
  std::mt19937 random{5};

  explicit Scene(int count) {
    camera.fx = camera.fy = 500.0;
    camera.cx = 319.5;
    camera.cy = 239.5;
    std::uniform_real_distribution<double> across(-1.0, 1.0), away(1.0, 4.0);
    for (int i = 0; i < count; ++i) {
      const double z = away(random);
      points.emplace_back(0.5 * z * across(random), 0.4 * z * across(random), z);
    }
  }

  Observation exact(const Se3& camera_from_world, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = camera_from_world * point;
    return {camera.project(p), p.z(), 1.0};
  }

  Se3 random_pose(double metres, double radians) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Vector6d t;
    for (int i = 0; i < 6; ++i) t[i] = unit(random) * (i < 3 ? metres : radians);
    return Se3::exp(t);
  }
};

}  // namespace dkp_slam::testing

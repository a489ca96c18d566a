#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"

namespace dkp_slam::testing {

/// Points in front of a camera at the origin, each with a descriptor of its own, and frames that
/// see them without any error. All features are on level 0 and upright.
struct PointWorld {
  Camera camera;
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;
  std::mt19937_64 random{11};

  explicit PointWorld(int count) {
    camera.fx = camera.fy = 500.0;
    camera.cx = 319.5;
    camera.cy = 239.5;
    std::uniform_real_distribution<double> across(-0.6, 0.6), away(1.5, 2.5);
    for (int i = 0; i < count; ++i) {
      const double z = away(random);
      points.emplace_back(z * across(random), 0.75 * z * across(random), z);
      descriptors.push_back(random_descriptor());
    }
  }

  Descriptor random_descriptor() { return {random(), random(), random(), random()}; }

  /// A frame at this pose, and in `point_of` which point each of its features shows.
  Frame frame_at(const Se3& camera_from_world, std::vector<int>& point_of) const {
    point_of.clear();
    OrbFeatures orb;
    std::vector<float> depths;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = camera_from_world * points[i];
      if (p.z() <= 0.1) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= 639 || pixel.y() >= 479) continue;
      orb.keypoints.emplace_back(float(pixel.x()), float(pixel.y()), 31.0F, 0.0F, 1.0F, 0);
      orb.descriptors.push_back(descriptors[i]);
      depths.push_back(static_cast<float>(p.z()));
      point_of.push_back(static_cast<int>(i));
    }
    Frame frame;
    frame.features = FrameFeatures(orb, cv::Mat::zeros(480, 640, CV_32F), camera);
    frame.features.depth = depths;
    frame.is_static.assign(depths.size(), 1);
    frame.landmark.assign(depths.size(), -1);
    frame.camera_from_world = camera_from_world;
    return frame;
  }

  /// Adds the frame to the map as a keyframe; features without a landmark get one, at their place.
  int add_keyframe(Map& map, Frame& frame, const std::vector<int>& point_of) const {
    Keyframe keyframe;
    keyframe.camera_from_world = frame.camera_from_world;
    keyframe.features = frame.features;
    keyframe.landmarks = frame.landmark;
    const int id = map.add_keyframe(std::move(keyframe));
    for (std::size_t f = 0; f < point_of.size(); ++f) {
      if (frame.landmark[f] >= 0) continue;
      frame.landmark[f] =
          map.add_landmark(points[static_cast<std::size_t>(point_of[f])], id, static_cast<int>(f));
    }
    map.update_covisibility(id);
    frame.reference_keyframe = id;
    return id;
  }
};

/// Metres and radians between two poses, whichever is more.
inline double pose_distance(const Se3& a, const Se3& b) {
  const Se3 difference = a.inverse() * b;
  return std::max(difference.translation.norm(), difference.angle());
}

inline Se3 pose(double x, double y, double z, double turn = 0.0) {
  Vector6d tangent;
  tangent << x, y, z, 0.0, turn, 0.0;
  return Se3::exp(tangent);
}

}  // namespace dkp_slam::testing

#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Directions in which a camera's pixels look, in its own frame, z = 1; with lens distortion.
class PixelRays {
 public:
  explicit PixelRays(const Camera& camera);

  bool made_for(const Camera& camera) const;
  /// Through a pixel's centre; x from -1 to the width, y from -1 to the height.
  Eigen::Vector3f at(int x, int y) const {
    const Eigen::Vector2f& d = directions_[index(x, y)];
    return {d.x(), d.y(), 1.0F};
  }
  /// Change of the direction from a pixel to the next one, along x and y; inside the image.
  Eigen::Vector2f right(int x, int y) const {
    return 0.5F * (directions_[index(x + 1, y)] - directions_[index(x - 1, y)]);
  }
  Eigen::Vector2f down(int x, int y) const {
    return 0.5F * (directions_[index(x, y + 1)] - directions_[index(x, y - 1)]);
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((y + 1) * (camera_.width + 2) + x + 1);
  }
  Camera camera_;
  std::vector<Eigen::Vector2f> directions_;
};

/// Where the camera is at one moment, in single precision: metres, world frame.
struct CameraPlace {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f origin;
  explicit CameraPlace(const Se3& world_from_camera = {})
      : rotation(world_from_camera.rotation.toRotationMatrix().cast<float>()),
        origin(world_from_camera.translation.cast<float>()) {}
  /// Into the world, of a direction in the camera's image plane.
  Eigen::Vector3f turn(const Eigen::Vector2f& in_plane) const {
    return in_plane.x() * rotation.col(0) + in_plane.y() * rotation.col(1);
  }
  /// Of a point in the world: metres along the camera's z.
  float depth(const Eigen::Vector3f& point) const { return rotation.col(2).dot(point - origin); }
  /// Of a point in the world: its pixel, up to the camera's focal lengths and centre.
  Eigen::Vector2f project(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f p = rotation.transpose() * (point - origin);
    const float inverse = 1.0F / p.z();
    return {p.x() * inverse, p.y() * inverse};
  }
};

/// What the camera does while a row gathers light.
struct RowExposure {
  double time = 0.0;  ///< seconds, of its middle
  CameraPlace middle, begin, end;
};

/// When and from where the rows of a frame see the world.
class Shutter {
 public:
  /// Row r of n is exposed around `time` + (r / (n - 1) - 1/2) `readout`, for `exposure` seconds.
  Shutter(const std::function<Se3(double)>& world_from_camera, int rows, double time,
          double exposure, double readout);

  const RowExposure& row(int y) const { return rows_[static_cast<std::size_t>(y)]; }
  /// From the first row's first light to the last row's last, seconds.
  double begin() const { return begin_; }
  double end() const { return end_; }
  double exposure() const { return exposure_; }
  /// 0 at `begin`, 1 at `end`.
  float moment(double time) const {
    return end_ > begin_ ? static_cast<float>((time - begin_) / (end_ - begin_)) : 0.0F;
  }

 private:
  double exposure_, begin_, end_;
  std::vector<RowExposure> rows_;
};

}  // namespace dkp_slam

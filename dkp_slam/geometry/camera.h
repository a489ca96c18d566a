#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/depth_correction.h"

namespace dkp_slam {

/// Brown-Conrady lens distortion, coefficients as in OpenCV and the TUM benchmark.
struct Distortion {
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
  bool none() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0 && k3 == 0.0; }
};

/// Standard deviation of a depth reading: sigma(z) = constant + quadratic * (z - 0.4 m)^2.
/// Form of Nguyen et al. 2012 ("Modeling Kinect Sensor Noise", Eq. 3).
struct DepthNoise {
  double constant = 0.0012;   ///< metres
  double quadratic = 0.0019;  ///< 1/metre
  double sigma(double depth) const {
    const double d = depth - 0.4;
    return constant + quadratic * d * d;
  }
};

/// A pinhole RGB-D camera, depth registered to colour. Pixels are (u, v), the centre of the top
/// left pixel at (0, 0); camera axes are x right, y down, z forward; metres.
struct Camera {
  std::string name;
  int width = 640;
  int height = 480;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< pixels
  Distortion distortion;
  double depth_scale = 5000.0;  ///< depth image units per metre
  double min_depth = 0.3;       ///< metres; nearer readings are unknown
  double max_depth = 8.0;       ///< metres; farther readings are unknown
  double baseline = 0.075;      ///< metres, of the virtual right camera (a Kinect's projector)
  double frame_rate = 30.0;     ///< colour images per second
  /// Seconds from the colour image's first row's exposure to the last one's; 0: global shutter.
  double readout = 0.0;
  /// The same of the depth image; nothing: as colour's, as in a Kinect. Time-of-flight cameras and
  /// stereo cameras with a global shutter have 0.
  std::optional<double> depth_readout;
  DepthNoise depth_noise;
  /// What is wrong with its depth images as they come; frames have been put right.
  DepthCorrection depth_correction;

  /// Undistorted pixel of a point in the camera frame (z > 0 is the caller's duty).
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  /// Point in the camera frame at `depth` metres along z, seen at an undistorted pixel.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double depth) const {
    return {(pixel.x() - cx) / fx * depth, (pixel.y() - cy) / fy * depth, depth};
  }
  /// Raw (distorted) pixel of an undistorted one.
  Eigen::Vector2d distort(const Eigen::Vector2d& pixel) const;
  /// Undistorted pixels of raw ones, by fixed-point iteration.
  std::vector<cv::Point2f> undistort(const std::vector<cv::Point2f>& raw) const;

  /// Seconds from the depth image's first row's moment to the last one's.
  double readout_of_depth() const { return depth_readout.value_or(readout); }

  /// The camera of images that have been put right and are stored so.
  Camera of_corrected_images() const {
    Camera camera = *this;
    camera.depth_correction = {};
    return camera;
  }

  cv::Matx33d matrix() const { return {fx, 0, cx, 0, fy, cy, 0, 0, 1}; }

  /// Why the parameters make no camera, one line, or nothing when they do.
  std::optional<std::string> check() const;
};

}  // namespace dkp_slam

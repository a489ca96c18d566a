#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

struct DepthViewOptions {
  double max_range = 5.0;  ///< metres; a Kinect's noise at 5 m is 4 cm and grows with the square
  /// Masks are grown by this share of the image's width: their edge, and that of depth, lie a few
  /// pixels off.
  double mask_margin = 0.0125;
  /// Depth that changes by more than this share from a pixel to its neighbours is of neither side
  /// of the edge: a Kinect invents points between the two.
  double edge = 0.04;
};

/// What one depth image says about the static world. All images CV_32FC1 or CV_8UC3 of the camera's
/// size, free of lens distortion; metres, 0 where nothing is known or was left out.
struct StaticView {
  cv::Mat surface;        ///< where surfaces are: outside masks, away from depth edges
  cv::Mat nearest;        ///< nothing is nearer than this, in a pixel or in those around it
  cv::Mat moving;         ///< depth of what lies in a mask; empty without masks
  cv::Mat colour;         ///< BGR
  Se3 world_from_camera;  ///< when the middle row of depth was taken
  /// Tangent (translation, rotation) per second of the camera's motion in its own frame; with it
  /// the rows of a rolling shutter find their moment (Camera::depth_readout).
  Vector6d velocity = Vector6d::Zero();
};

/// Makes views of a camera's frames.
class DepthViewer {
 public:
  /// Throws `Error` for options that make no sense.
  explicit DepthViewer(const Camera& camera, const DepthViewOptions& options = {});

  /// Colour, depth and mask of the frame must be of the camera's size; without a mask all of it is
  /// taken for static. Throws `Error` for images of another type or size.
  StaticView view(const RgbdFrame& frame, const Se3& world_from_camera,
                  const Vector6d& velocity = Vector6d::Zero()) const;

  const Camera& camera() const { return camera_; }
  const DepthViewOptions& options() const { return options_; }

 private:
  void check(const RgbdFrame& frame) const;
  /// Depth without lens distortion, of what is static and, where there is a mask, of what moves.
  void split_depth(const RgbdFrame& frame, cv::Mat& still, cv::Mat& moving) const;

  Camera camera_;
  DepthViewOptions options_;
  cv::Mat map_x_, map_y_;  // raw pixel of each undistorted one; empty without distortion
};

}  // namespace dkp_slam

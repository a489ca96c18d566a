#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// A keyframe's images as they are kept until they are fused, and fused again: 6 bytes a pixel.
struct KeyframeImage {
  double timestamp = 0.0;    ///< seconds
  double depth_delay = 0.0;  ///< seconds from colour to depth
  cv::Mat depth;             ///< CV_16UC1, `unit` metres, 0 where unknown
  cv::Mat colour;            ///< CV_8UC3, BGR
  cv::Mat mask;              ///< CV_8UC1, 0 on what is static; empty where nothing moves
  double farthest = 0.0;     ///< metres, of all depth
  /// Tangent per second of the camera's motion in its own frame (StaticView::velocity).
  Vector6d velocity = Vector6d::Zero();

  static constexpr double unit = 0.0002;
};

/// The camera of images that are kept: at most about `width` pixels wide, but a whole fraction of
/// the original.
Camera kept_camera(const Camera& camera, int width);

/// A frame's images in the size of `kept`. `mask`: of the frame's size, or empty.
KeyframeImage keep_image(const RgbdFrame& frame, const cv::Mat& mask, const Camera& kept,
                         const Vector6d& velocity = Vector6d::Zero());

/// The frame that was kept, with its mask.
RgbdFrame frame_of(const KeyframeImage& image);

}  // namespace dkp_slam

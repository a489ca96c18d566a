#include "dkp_slam/dense/keyframe_image.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {

Camera kept_camera(const Camera& camera, int width) {
  const int parts = std::max(1, camera.width / std::max(1, width));
  return parts == 1 ? camera : resized(camera, camera.width / parts, camera.height / parts);
}

KeyframeImage keep_image(const RgbdFrame& frame, const cv::Mat& mask, const Camera& kept,
                         const Vector6d& velocity) {
  const cv::Size size(kept.width, kept.height);
  KeyframeImage image;
  image.timestamp = frame.timestamp;
  image.depth_delay = frame.depth_delay;
  image.velocity = velocity;
  cv::Mat depth;
  cv::resize(frame.depth, depth, size, 0, 0, cv::INTER_NEAREST);  // between two depths is none
  depth.convertTo(image.depth, CV_16U, 1.0 / KeyframeImage::unit);
  double most = 0.0;
  cv::minMaxLoc(image.depth, nullptr, &most);
  image.farthest = most * KeyframeImage::unit;
  cv::resize(frame.colour, image.colour, size, 0, 0, cv::INTER_AREA);
  if (!mask.empty()) {
    const cv::Mat moving = mask != 0;
    cv::resize(moving, image.mask, size, 0, 0, cv::INTER_AREA);  // any pixel in it counts
  }
  return image;
}

RgbdFrame frame_of(const KeyframeImage& image) {
  RgbdFrame frame;
  frame.timestamp = image.timestamp;
  frame.depth_delay = image.depth_delay;
  frame.colour = image.colour;
  frame.mask = image.mask;
  image.depth.convertTo(frame.depth, CV_32F, KeyframeImage::unit);
  return frame;
}

}  // namespace dkp_slam

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// A sensor_msgs/Image, or a sensor_msgs/CompressedImage (`compressed`, without size and step), as
/// plain values that point into the message.
struct RosImage {
  std::string encoding;  ///< "bgr8", "16UC1", ...; of a compressed one its format
  std::uint32_t width = 0, height = 0;
  std::uint32_t step = 0;  ///< bytes from row to row
  bool big_endian = false;
  bool compressed = false;
  std::span<const std::uint8_t> data;
};

/// CV_8UC3 BGR of rgb8, bgr8, rgba8, bgra8, mono8, 8UC1, 8UC3, yuv422 (UYVY), yuv422_yuy2 (YUYV),
/// the Bayer patterns, and of JPEG and PNG. Throws `Error` for any other encoding and for data that
/// do not fit the size. Holds nothing of the message.
cv::Mat colour_of(const RosImage& image);

/// CV_32FC1 metres, 0 where unknown, of 16UC1 and mono16 with so many units a metre, of 32FC1 in
/// metres, and of both as compressed_depth_image_transport packs them. Throws as `colour_of`.
cv::Mat depth_of(const RosImage& image, double units_per_metre);

/// What a sensor_msgs/CameraInfo says.
struct RosCameraInfo {
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};   ///< of the image as the lens gives it
  std::array<double, 12> p{};  ///< of the rectified one
};

/// The camera; `rectified`: of an image that was rectified, without distortion. Throws `Error` for
/// a camera that was never calibrated and for a model of distortion other than plumb_bob's five
/// coefficients.
Camera camera_of(const RosCameraInfo& info, bool rectified);

}  // namespace dkp_slam

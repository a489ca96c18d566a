#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>

#include <geometry_msgs/Transform.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Float32.h>
#include <boost/shared_ptr.hpp>

#include "dkp_slam/sensor/bag/ros_image.h"

namespace dkp_slam::ros1 {

// Messages of ROS 1 and views of them, for those who are built with ROS.

/// Debian's headers of messages ask their allocator for `rebind`, which std::allocator has no more
/// in C++20. With this one the same fields and bytes come out. ROS makes arrays as long as a
/// message says before it looks whether so much has come: what no image needs is refused.
template <class T>
struct Allocator : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = Allocator<Other>;
  };
  Allocator() = default;
  template <class Other>
  Allocator(const Allocator<Other>&) {}
  template <class Other>
  operator std::allocator<Other>() const {
    return {};
  }
  T* allocate(std::size_t count) {
    constexpr std::size_t most_bytes = std::size_t{1} << 28U;
    if (count > most_bytes / sizeof(T))
      throw std::length_error("an array of a message is longer than 256 MB");
    return std::allocator<T>::allocate(count);
  }
};
template <>
template <>
struct Allocator<void>::rebind<char> {
  using other = std::allocator<char>;  // so that texts are std::string
};

using CameraInfo = sensor_msgs::CameraInfo_<Allocator<void>>;
using CompressedImage = sensor_msgs::CompressedImage_<Allocator<void>>;
using Float32 = std_msgs::Float32_<Allocator<void>>;
using Image = sensor_msgs::Image_<Allocator<void>>;
using Transform = geometry_msgs::Transform_<Allocator<void>>;

/// Valid while the message is.
inline RosImage view_of(const Image& message) {
  RosImage image;
  image.encoding = message.encoding;
  image.width = message.width;
  image.height = message.height;
  image.step = message.step;
  image.big_endian = message.is_bigendian != 0;
  image.data = {message.data.data(), message.data.size()};
  return image;
}

inline RosImage view_of(const CompressedImage& message) {
  RosImage image;
  image.encoding = message.format;
  image.compressed = true;
  image.data = {message.data.data(), message.data.size()};
  return image;
}

/// An image as it came; one of the two.
struct ImageMessage {
  boost::shared_ptr<const Image> raw;
  boost::shared_ptr<const CompressedImage> compressed;

  RosImage view() const { return raw ? view_of(*raw) : view_of(*compressed); }
};

inline RosCameraInfo values_of(const CameraInfo& message) {
  RosCameraInfo info;
  info.width = message.width;
  info.height = message.height;
  info.distortion_model = message.distortion_model;
  info.d.assign(message.D.begin(), message.D.end());
  std::copy(message.K.begin(), message.K.end(), info.k.begin());
  std::copy(message.P.begin(), message.P.end(), info.p.begin());
  return info;
}

}  // namespace dkp_slam::ros1

#pragma once

#include <cstring>
#include <string>

#include <rosbag/bag.h>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/bag/ros_messages.h"

namespace dkp_slam::testing {

/// Writes a bag, by rosbag itself; it is whole when this goes.
class TestBag {
 public:
  explicit TestBag(const std::string& file) : bag_(file, rosbag::bagmode::Write) {}

  /// A picture of 6 x 4 pixels, each of another colour.
  static cv::Mat pattern() {
    cv::Mat image(4, 6, CV_8UC3);
    for (int i = 0; i < 24; ++i) image.at<cv::Vec3b>(i / 6, i % 6) = cv::Vec3b(i, 100 + i, 250 - i);
    return image;
  }

  void image(const std::string& topic, double stamp, const cv::Mat& pixels,
             const std::string& encoding) {
    ros1::Image message;
    message.header.stamp = ros::Time(stamp);
    message.width = static_cast<std::uint32_t>(pixels.cols);
    message.height = static_cast<std::uint32_t>(pixels.rows);
    message.encoding = encoding;
    message.step = static_cast<std::uint32_t>(pixels.cols * pixels.elemSize());
    message.data.resize(message.step * message.height);
    std::memcpy(message.data.data(), pixels.data, message.data.size());
    bag_.write(topic, ros::Time(stamp), message);
  }
  /// `shift`: of the centre from the middle of the image, pixels.
  void info(const std::string& topic, double stamp, const cv::Size& size, double focal,
            double shift = 0.0) {
    ros1::CameraInfo message;
    message.width = static_cast<std::uint32_t>(size.width);
    message.height = static_cast<std::uint32_t>(size.height);
    message.distortion_model = "plumb_bob";
    message.D.assign(5, 0.0);
    const double cx = (size.width - 1) / 2.0 + shift, cy = (size.height - 1) / 2.0;
    message.K = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
    message.P = {focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0};
    bag_.write(topic, at(stamp), message);
  }
  void transform(const std::string& topic, const Se3& pose) {
    ros1::Transform message;
    message.rotation.w = pose.rotation.w();
    message.rotation.x = pose.rotation.x();
    message.rotation.y = pose.rotation.y();
    message.rotation.z = pose.rotation.z();
    message.translation.x = pose.translation.x();
    message.translation.y = pose.translation.y();
    message.translation.z = pose.translation.z();
    bag_.write(topic, at(0.0), message);
  }
  void number(const std::string& topic, float value) {
    ros1::Float32 message;
    message.data = value;
    bag_.write(topic, at(0.0), message);
  }

 private:
  /// What rosbag takes for a time: not 0.
  static ros::Time at(double stamp) { return stamp > 0.0 ? ros::Time(stamp) : ros::TIME_MIN; }

  rosbag::Bag bag_;
};

}  // namespace dkp_slam::testing

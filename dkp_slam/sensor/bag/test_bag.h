#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include <bzlib.h>
#include <rosbag/bag.h>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/bag/ros_messages.h"

namespace dkp_slam::testing {

/// Writes a bag, by rosbag itself; it is whole when this goes.
class TestBag {
 public:
  explicit TestBag(const std::string& file,
                   rosbag::CompressionType compression = rosbag::compression::Uncompressed)
      : bag_(file, rosbag::bagmode::Write) {
    bag_.setCompression(compression);
  }

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

/// The bytes of a bag whose one chunk is not compressed, and what that holds.
struct PlainBag {
  std::string head, chunk, index;

  explicit PlainBag(const std::string& bag) {
    constexpr std::size_t first_line = 13;
    const std::size_t begin = end_of_record(bag, first_line);
    const std::size_t end = end_of_record(bag, begin), size = size_at(bag, begin);
    head = bag.substr(0, begin);
    chunk = bag.substr(begin + size + 8, end - begin - size - 8);
    index = bag.substr(end);
    end_ = end;
  }

  /// The bag with this chunk, packed by bzip2, said to hold `said` bytes more than it does.
  std::string packed(std::uint32_t said = 0) const {
    std::string data(chunk.size() + chunk.size() / 100 + 600, '\0');
    auto size = static_cast<unsigned>(data.size());
    std::string bytes = chunk;
    if (BZ2_bzBuffToBuffCompress(data.data(), &size, bytes.data(),
                                 static_cast<unsigned>(bytes.size()), 9, 0, 0) != BZ_OK) {
      return {};
    }
    data.resize(size);
    const auto whole = static_cast<std::uint32_t>(chunk.size()) + said;
    const std::string header =
        sized("compression=bz2") + sized(std::string("op=\5")) + sized("size=" + text_of(whole));
    std::string bag = head + sized(header) + sized(data);
    // What it names lies behind the chunk.
    const std::size_t place = bag.find("index_pos=") + 10;
    std::uint64_t index_place = 0;
    std::memcpy(&index_place, &bag[place], sizeof(index_place));
    index_place += bag.size() - end_;
    bag.replace(place, sizeof(index_place), text_of(index_place));
    return bag + index;
  }

 private:
  template <class Number>
  static std::string text_of(Number number) {
    return {reinterpret_cast<const char*>(&number), sizeof(number)};
  }
  static std::string sized(const std::string& text) {
    return text_of(static_cast<std::uint32_t>(text.size())) + text;
  }
  static std::size_t size_at(const std::string& bag, std::size_t at) {
    std::uint32_t size = 0;
    std::memcpy(&size, &bag[at], sizeof(size));
    return size;
  }
  static std::size_t end_of_record(const std::string& bag, std::size_t at) {
    at += 4 + size_at(bag, at);
    return at + 4 + size_at(bag, at);
  }

  std::size_t end_ = 0;  // of the chunk as it was
};

}  // namespace dkp_slam::testing

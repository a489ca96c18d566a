#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/stream/channel.h"
#include "dkp_slam/sensor/stream/stream_format.h"

namespace dkp_slam::testing {

/// A driver's connection to a program that listens.
class DriverConnection {
 public:
  explicit DriverConnection(const std::string& address)
      : output_(StreamAddress::parse(address), ChannelOptions(), 20.0) {}
  void send(const std::string& bytes) {
    if (!output_.write(bytes)) throw std::runtime_error("stopped");
  }

 private:
  ByteOutput output_;
};

/// A header that says this, with a camera file.
inline std::string header_of(stream::Header header, const std::string& camera) {
  header.camera_bytes = static_cast<std::uint32_t>(camera.size());
  return stream::encode(header) + camera;
}

inline std::string bytes_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

inline std::string frame_of(double timestamp, const cv::Mat& colour, const cv::Mat& depth,
                            const cv::Mat& mask = {}, double delay = 0.0) {
  const std::string body =
      stream::encode_stamps(timestamp, delay) + bytes_of(colour) + bytes_of(depth) + bytes_of(mask);
  const auto bytes = static_cast<std::uint32_t>(body.size());
  return stream::encode({stream::RecordKind::frame, bytes}) + body;
}

inline std::string end_of_stream() { return stream::encode({stream::RecordKind::end, 0}); }

}  // namespace dkp_slam::testing

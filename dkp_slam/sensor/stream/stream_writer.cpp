#include "dkp_slam/sensor/stream/stream_writer.h"

#include <cstdint>
#include <span>
#include <string>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/stream/stream_format.h"

namespace dkp_slam {
namespace {

stream::Header header_of(const Camera& camera, std::size_t camera_bytes) {
  stream::Header header;
  header.width = static_cast<std::uint32_t>(camera.width);
  header.height = static_cast<std::uint32_t>(camera.height);
  header.camera_bytes = static_cast<std::uint32_t>(camera_bytes);
  header.depth_scale = camera.depth_scale;
  return header;
}

std::span<const char> bytes_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

cv::Mat whole(const cv::Mat& image) { return image.isContinuous() ? image : image.clone(); }

}  // namespace

StreamWriter::StreamWriter(ByteOutput& output, const Camera& camera)
    : output_(output), camera_(camera) {}

bool StreamWriter::begin() {
  const std::string camera = camera_text(camera_.of_corrected_images());
  return output_.write(stream::encode(header_of(camera_, camera.size())) + camera);
}

bool StreamWriter::write(const RgbdFrame& frame) {
  const cv::Size size(camera_.width, camera_.height);
  const bool mask = !frame.mask.empty();
  if (frame.colour.type() != CV_8UC3 || frame.depth.type() != CV_32FC1 ||
      frame.colour.size() != size || frame.depth.size() != size ||
      (mask && (frame.mask.type() != CV_8UC1 || frame.mask.size() != size))) {
    throw Error(fmt::format("frame {}: its images are not of the camera's {} x {} pixels",
                            frame.index, size.width, size.height));
  }
  const stream::Header header = header_of(camera_, 0);
  const stream::RecordHead head{stream::RecordKind::frame,
                                static_cast<std::uint32_t>(header.frame_bytes(mask))};
  return output_.write(stream::encode(head) +
                       stream::encode_stamps(frame.timestamp, frame.depth_delay)) &&
         output_.write(bytes_of(whole(frame.colour))) &&
         output_.write(bytes_of(depth_in_units(frame.depth, camera_.depth_scale))) &&
         (!mask || output_.write(bytes_of(whole(frame.mask))));
}

bool StreamWriter::end() {
  return output_.write(stream::encode(stream::RecordHead{stream::RecordKind::end, 0}));
}

}  // namespace dkp_slam

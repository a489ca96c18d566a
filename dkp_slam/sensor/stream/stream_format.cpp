#include "dkp_slam/sensor/stream/stream_format.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam::stream {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie");

constexpr std::string_view frame_tag = "FRME", end_tag = "DONE";

template <class T>
void put(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Takes numbers off the front.
class Reader {
 public:
  explicit Reader(std::span<const char> bytes) : bytes_(bytes) {}
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(value));
    bytes_ = bytes_.subspan(sizeof(value));
    return value;
  }

 private:
  std::span<const char> bytes_;
};

std::string as_hex(std::span<const char> bytes) {
  std::string text;
  for (const char c : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return text;
}

void check(const Header& header) {
  if (header.width == 0 || header.height == 0 ||
      std::uint64_t{header.width} * header.height > most_pixels) {
    throw Error(
        fmt::format("its header says {} x {} pixels; give width and height as unsigned 32-bit "
                    "little-endian numbers, together at most {} pixels",
                    header.width, header.height, +most_pixels));
  }
  const auto colour = static_cast<std::uint32_t>(header.colour);
  if (colour < 1 || colour > 3) {
    throw Error(
        fmt::format("its header says colour format {}; 1 is bgr8, 2 rgb8, 3 grey8", colour));
  }
  const auto depth = static_cast<std::uint32_t>(header.depth);
  if (depth < 1 || depth > 2) {
    throw Error(
        fmt::format("its header says depth format {}; 1 is 16-bit units, 2 32-bit metres", depth));
  }
  if (header.camera_bytes > most_camera_bytes) {
    throw Error(fmt::format("its header says {} bytes of camera file; at most {}",
                            header.camera_bytes, +most_camera_bytes));
  }
  if (!std::isfinite(header.depth_scale) || header.depth_scale <= 0.0) {
    throw Error(
        fmt::format("its header says {} depth units per metre; must be above 0 (1000 for "
                    "millimetres)",
                    header.depth_scale));
  }
}

}  // namespace

std::string encode(const Header& header) {
  std::string bytes(magic.begin(), magic.end());
  put(bytes, version);
  put(bytes, header.width);
  put(bytes, header.height);
  put(bytes, header.colour);
  put(bytes, header.depth);
  put(bytes, header.camera_bytes);
  put(bytes, header.depth_scale);
  return bytes;
}

std::string encode(const RecordHead& head) {
  std::string bytes(head.kind == RecordKind::frame ? frame_tag : end_tag);
  put(bytes, head.bytes);
  return bytes;
}

std::string encode_stamps(double timestamp, double depth_delay) {
  std::string bytes;
  put(bytes, timestamp);
  put(bytes, depth_delay);
  return bytes;
}

Header parse_header(std::span<const char, header_bytes> bytes) {
  if (!std::equal(magic.begin(), magic.end(), bytes.begin())) {
    throw Error(
        fmt::format("is no frame stream: it begins with bytes {}, not with \"DKPSLAM\" "
                    "and a 0; see docs/frame-stream.md",
                    as_hex(bytes.first(magic.size()))));
  }
  Reader reader(bytes.subspan(magic.size()));
  if (const auto its = reader.take<std::uint32_t>(); its != version) {
    throw Error(fmt::format("is a frame stream of version {}, this program reads version {} only",
                            its, +version));
  }
  Header header;
  header.width = reader.take<std::uint32_t>();
  header.height = reader.take<std::uint32_t>();
  header.colour = reader.take<ColourFormat>();
  header.depth = reader.take<DepthFormat>();
  header.camera_bytes = reader.take<std::uint32_t>();
  header.depth_scale = reader.take<double>();
  check(header);
  return header;
}

RecordHead parse_record_head(std::span<const char, record_head_bytes> bytes, const Header& header) {
  const std::string_view tag(bytes.data(), frame_tag.size());
  const auto length = Reader(bytes.subspan(frame_tag.size())).take<std::uint32_t>();
  if (tag == end_tag && length == 0) return {RecordKind::end, 0};
  if (tag != frame_tag) {
    throw Error(
        fmt::format("bytes {} where a record must begin (\"FRME\", or \"DONE\" and a "
                    "length of 0); the driver wrote too much or too little before",
                    as_hex(bytes)));
  }
  if (length != header.frame_bytes(false) && length != header.frame_bytes(true)) {
    throw Error(fmt::format(
        "a frame of {} bytes, where {} x {} pixels of its formats take {}, or "
        "{} with a mask",
        length, header.width, header.height, header.frame_bytes(false), header.frame_bytes(true)));
  }
  return {RecordKind::frame, length};
}

}  // namespace dkp_slam::stream

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace dkp_slam {

/// How a stream of frames looks on a pipe or socket; docs/frame-stream.md. All numbers are
/// little-endian.
namespace stream {

constexpr std::array<char, 8> magic = {'D', 'K', 'P', 'S', 'L', 'A', 'M', '\0'};
constexpr std::uint32_t version = 1;
constexpr std::size_t header_bytes = 40, record_head_bytes = 8, frame_stamps_bytes = 16;
/// More than any depth camera has: what a header asks for is checked before memory is taken.
constexpr std::uint64_t most_pixels = 4096 * 4096;
constexpr std::uint32_t most_camera_bytes = 65536;

enum class ColourFormat : std::uint32_t { bgr8 = 1, rgb8 = 2, grey8 = 3 };
enum class DepthFormat : std::uint32_t { u16 = 1, f32 = 2 };

struct Header {
  std::uint32_t width = 0, height = 0;  ///< pixels, of colour, depth and mask
  ColourFormat colour = ColourFormat::bgr8;
  DepthFormat depth = DepthFormat::u16;
  std::uint32_t camera_bytes = 0;  ///< of the camera file that follows the header; 0: none does
  double depth_scale = 5000.0;     ///< units per metre of DepthFormat::u16

  std::size_t pixels() const { return std::size_t{width} * height; }
  std::size_t colour_bytes() const { return pixels() * (colour == ColourFormat::grey8 ? 1 : 3); }
  std::size_t depth_bytes() const { return pixels() * (depth == DepthFormat::u16 ? 2 : 4); }
  /// Of a frame's record, behind its head.
  std::size_t frame_bytes(bool mask) const {
    return frame_stamps_bytes + colour_bytes() + depth_bytes() + (mask ? pixels() : 0);
  }
  bool operator==(const Header&) const = default;
};

enum class RecordKind { frame, end };

struct RecordHead {
  RecordKind kind = RecordKind::end;
  std::uint32_t bytes = 0;  ///< that follow
};

std::string encode(const Header& header);
std::string encode(const RecordHead& head);
/// Time stamp and depth delay, seconds (RgbdFrame).
std::string encode_stamps(double timestamp, double depth_delay);

/// Throws `Error`, one line without the stream's name, for what is no header of this version or
/// asks for more than a camera has.
Header parse_header(std::span<const char, header_bytes> bytes);
/// Throws `Error` for what is no record of such a stream.
RecordHead parse_record_head(std::span<const char, record_head_bytes> bytes, const Header& header);

}  // namespace stream
}  // namespace dkp_slam

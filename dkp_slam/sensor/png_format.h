#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

/// What the PNG specification (ISO/IEC 15948) fixes, for decoder and encoder.
namespace dkp_slam::png {

inline constexpr std::uint8_t signature[8] = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::uint8_t colour_grey = 0, colour_rgb = 2;  ///< colour types of the header

inline bool has_signature(std::span<const std::uint8_t> file) {
  return file.size() >= sizeof(signature) &&
         std::equal(std::begin(signature), std::end(signature), file.begin());
}

/// The number in four bytes.
inline std::uint32_t big_endian(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

}  // namespace dkp_slam::png

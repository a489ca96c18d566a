#pragma once

#include <cstdint>

/// What the PNG specification (ISO/IEC 15948) fixes, for decoder and encoder.
namespace dkp_slam::png {

inline constexpr std::uint8_t signature[8] = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::uint8_t colour_grey = 0, colour_rgb = 2;  ///< colour types of the header

}  // namespace dkp_slam::png

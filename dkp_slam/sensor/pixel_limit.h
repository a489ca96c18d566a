#pragma once

#include <cstdint>

namespace dkp_slam {

inline constexpr const char* too_many_pixels =
    "the image has more pixels than any that belongs here";

/// Whether an image of that size, as a file states it, has more than `most_pixels`: a small file
/// may state gigabytes.
constexpr bool has_too_many_pixels(std::uint64_t width, std::uint64_t height,
                                   std::uint64_t most_pixels) {
  return width != 0 && height > most_pixels / width;
}

}  // namespace dkp_slam

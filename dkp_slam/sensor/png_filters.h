#pragma once

#include <cstddef>
#include <cstdint>

namespace dkp_slam::png {

/// Bytes behind the last filtered row and behind every decoded one that may be read and written:
/// pixels are taken four bytes at a time, whatever their size.
inline constexpr std::size_t row_padding = 4;

/// Undoes the filters of all rows (PNG specification, section 9). `in` has a byte before each row
/// that names its filter; rows of `out` are `row_bytes` + `row_padding` apart. Pixels have 1, 2 or
/// 3 bytes. False when a row names a filter that does not exist.
bool undo_filters(const std::uint8_t* in, std::uint8_t* out, int height, std::size_t row_bytes,
                  int pixel_bytes);

}  // namespace dkp_slam::png

#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

namespace dkp_slam {

/// How a folder of images is read.
struct TumOptions {
  /// Seconds between a colour and a depth image that still belong together, exclusive; used where
  /// there is no associations.txt. Default of the TUM benchmark's associate.py.
  double max_difference = 0.02;
  /// Pairs left out at the beginning; the first one read has index 0 all the same.
  std::size_t first_frame = 0;
  /// Pairs read at most; nothing: all of them.
  std::optional<std::size_t> frame_limit;
  /// Folder of masks (RgbdFrame::mask), each named like its colour image: STEM.png, 8-bit grey, of
  /// the image's size. Empty: none are read.
  std::filesystem::path masks;
};

}  // namespace dkp_slam

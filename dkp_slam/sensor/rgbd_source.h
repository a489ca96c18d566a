#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// Yields frames in the order of their time stamps. `read` may be called from one thread at a time.
class RgbdSource {
 public:
  virtual ~RgbdSource() = default;

  /// What the source is, for reports: a folder's path, a device's name.
  virtual std::string description() const = 0;
  /// Frames in all, where it is known beforehand.
  virtual std::optional<std::size_t> size() const = 0;
  /// The next frame; nothing at the end. A frame that cannot be read is skipped with a warning and
  /// counted; its index is not given to another. Throws `Error` when going on makes no sense.
  virtual std::optional<RgbdFrame> read() = 0;
  /// Frames skipped so far because an image could not be read.
  virtual std::size_t skipped() const = 0;
  /// Frames given so far without a mask, where the source has masks.
  virtual std::size_t without_mask() const { return 0; }
};

}  // namespace dkp_slam

#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dkp_slam {

/// Seconds of a Kinect's images by its counter, which has 32 bits, 60 million ticks a second, and
/// begins anew every 71.6 s and when the device is opened.
class KinectClock {
 public:
  /// A device was opened: its first image is taken to be of `now` (seconds, of whatever clock), or
  /// a little after the last image of the device before, where that is later.
  void restart(double now) {
    constexpr double apart = 0.1;  // seconds: more than two images that belong together
    start_ = last_ ? std::max(now, *last_ + apart) : now;
    ticks_.reset();
    total_ = 0;
  }

  /// `restart` comes first. Images of colour and depth may come a little out of order.
  double seconds(std::uint32_t ticks) {
    if (ticks_) total_ += static_cast<std::int32_t>(ticks - *ticks_);
    ticks_ = ticks;
    constexpr double rate = 60e6;
    const double time = start_ + static_cast<double>(total_) / rate;
    last_ = last_ ? std::max(*last_, time) : time;
    return time;
  }

 private:
  double start_ = 0.0;
  std::optional<std::uint32_t> ticks_;
  std::int64_t total_ = 0;  // since the first image of this device
  std::optional<double> last_;
};

}  // namespace dkp_slam

#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam {

/// Reads another source ahead in a thread of its own, so that decoding overlaps with tracking. Same
/// frames in the same order; an exception of the other source comes out of `read` after the frames
/// before it, and again on every later call.
class PrefetchingSource : public RgbdSource {
 public:
  /// `capacity` frames (2.1 MB each at 640 x 480) are kept ready at most: enough to even out frames
  /// that take longer to read than to track.
  explicit PrefetchingSource(std::unique_ptr<RgbdSource> source, std::size_t capacity = 4);
  /// Stops reading, also in the middle of the sequence.
  ~PrefetchingSource() override;
  PrefetchingSource(const PrefetchingSource&) = delete;
  PrefetchingSource& operator=(const PrefetchingSource&) = delete;

  std::string description() const override { return description_; }
  std::optional<std::size_t> size() const override { return size_; }
  std::optional<RgbdFrame> read() override;
  /// Frames skipped up to the last one that `read` returned, not up to where reading ahead is.
  std::size_t skipped() const override { return skipped_; }

 private:
  struct Item {
    std::optional<RgbdFrame> frame;  ///< nothing at the end
    std::size_t skipped = 0;
    std::exception_ptr error;
  };

  void read_ahead();

  const std::unique_ptr<RgbdSource> source_;  ///< used by `thread_` only, once that runs
  const std::size_t capacity_;
  const std::string description_;
  const std::optional<std::size_t> size_;
  std::size_t skipped_ = 0;  ///< belongs to the caller of `read`

  std::mutex mutex_;  ///< guards `queue_` and `stop_`
  std::condition_variable changed_;
  std::deque<Item> queue_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace dkp_slam

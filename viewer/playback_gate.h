#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam::viewer {

/// Pause and step of a playback, by whoever watches. A pause lasts no longer than somebody does:
/// when no page is left, and none comes within `grace`, the playback goes on.
class PlaybackGate {
 public:
  /// A reload is over sooner.
  static constexpr std::chrono::milliseconds grace{2000};

  /// `paused`: from the beginning, for as long as it takes until the first page opens.
  explicit PlaybackGate(bool paused = false) : paused_(paused) {}

  void pause(bool paused);
  /// Lets one more frame through, and no other.
  void step();
  void page_opened();
  void page_closed();
  bool paused();
  int pages() const;

  /// Waits while paused, until a step is asked for or `stop` is set (which may be null).
  void wait(const std::atomic<bool>* stop);

 private:
  using Clock = std::chrono::steady_clock;
  bool holds();  // with the mutex held

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_;
  bool watched_ = false;  // by a page, now or before
  int steps_ = 0;
  int pages_ = 0;
  Clock::time_point last_closed_;
};

/// A source that waits at a gate before every frame.
class GatedSource : public RgbdSource {
 public:
  /// `gate`: null for none. `stop`: ends the waiting; may be null.
  GatedSource(std::unique_ptr<RgbdSource> source, std::shared_ptr<PlaybackGate> gate,
              const std::atomic<bool>* stop)
      : source_(std::move(source)), gate_(std::move(gate)), stop_(stop) {}

  std::string description() const override { return source_->description(); }
  std::optional<std::size_t> size() const override { return source_->size(); }
  std::optional<RgbdFrame> read() override {
    if (gate_) gate_->wait(stop_);
    return source_->read();
  }
  std::size_t skipped() const override { return source_->skipped(); }
  std::size_t without_mask() const override { return source_->without_mask(); }

 private:
  const std::unique_ptr<RgbdSource> source_;
  const std::shared_ptr<PlaybackGate> gate_;
  const std::atomic<bool>* const stop_;
};

}  // namespace dkp_slam::viewer

#include "dkp_slam/system/playback.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>

#include "dkp_slam/stopwatch.h"

namespace dkp_slam {
namespace {

using Clock = std::chrono::steady_clock;

/// When frames are due that are played by their time stamps.
class Pace {
 public:
  explicit Pace(double rate) : rate_(rate) {}
  Clock::time_point due(double timestamp) {
    if (!started_) {
      started_ = true;
      start_ = Clock::now();
      first_timestamp_ = timestamp;
    }
    const std::chrono::duration<double> since((timestamp - first_timestamp_) / rate_);
    return start_ + std::chrono::duration_cast<Clock::duration>(since);
  }

 private:
  const double rate_;
  bool started_ = false;
  Clock::time_point start_;
  double first_timestamp_ = 0.0;
};

bool stopped(const PlaybackOptions& options) { return options.stop && *options.stop; }

void sleep_until(Clock::time_point moment, const PlaybackOptions& options) {
  constexpr auto look = std::chrono::milliseconds(50);  // at `stop`
  while (!stopped(options) && Clock::now() < moment) {
    std::this_thread::sleep_until(std::min(moment, Clock::now() + look));
  }
}

}  // namespace

void play(RgbdSource& source, Slam& slam, const PlaybackOptions& options,
          const std::function<void(const FrameResult&)>& use) {
  const auto hand_on = [&](const std::optional<FrameResult>& result) {
    if (result && use) use(*result);
    return result.has_value();
  };
  Pace pace(options.rate);
  std::exception_ptr failure;
  try {
    while (!stopped(options)) {
      const Stopwatch watch;
      std::optional<RgbdFrame> frame = source.read();
      if (!frame) break;
      frame->decode_ms = watch.ms();
      if (options.rate > 0.0) sleep_until(pace.due(frame->timestamp), options);
      slam.feed(std::move(*frame));
      if (options.one_at_a_time) {
        hand_on(slam.wait());
      } else {
        while (hand_on(slam.poll())) {
        }
      }
    }
  } catch (...) {
    failure = std::current_exception();
  }
  slam.finish(options.stop);
  try {
    while (hand_on(slam.poll())) {
    }
  } catch (...) {
    if (!failure) failure = std::current_exception();  // the first is the cause
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace dkp_slam

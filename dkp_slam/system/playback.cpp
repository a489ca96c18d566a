#include "dkp_slam/system/playback.h"

#include <exception>
#include <optional>

#include "dkp_slam/stopwatch.h"
#include "dkp_slam/system/pace.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {
namespace {

bool stopped(const PlaybackOptions& options) { return options.stop && *options.stop; }

std::optional<RgbdFrame> read(RgbdSource& source) {
  const TraceSpan span("read");
  return source.read();
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
      std::optional<RgbdFrame> frame = read(source);
      if (!frame) break;
      frame->decode_ms = watch.ms();
      if (options.rate > 0.0) pace.wait_for(frame->timestamp, options.stop);
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

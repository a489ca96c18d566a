#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam {

struct PlaybackOptions {
  /// By the time stamps, this much faster; 0: as fast as the system takes them. For a live system.
  double rate = 0.0;
  /// Read a frame only when the one before has its result. Slower, but every stage has the machine
  /// to itself, so that its time is its own. Not with `rate`.
  bool one_at_a_time = false;
  /// Ends the playback when set, and the final adjustment. May be null.
  const std::atomic<bool>* stop = nullptr;
};

/// Feeds a source to the system until its end, gives each result to `use` on the calling thread,
/// and finishes. Throws what the source, the system or `use` threw, once the frames before have
/// been finished and given to `use`.
void play(RgbdSource& source, Slam& slam, const PlaybackOptions& options = {},
          const std::function<void(const FrameResult&)>& use = {});

}  // namespace dkp_slam

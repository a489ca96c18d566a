#include "viewer/playback_gate.h"

#include <algorithm>

namespace dkp_slam::viewer {

void PlaybackGate::pause(bool paused) {
  {
    const std::lock_guard lock(mutex_);
    paused_ = paused;
    steps_ = 0;
  }
  changed_.notify_all();
}

void PlaybackGate::step() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = true;
    ++steps_;
  }
  changed_.notify_all();
}

void PlaybackGate::page_opened() {
  const std::lock_guard lock(mutex_);
  ++pages_;
  watched_ = true;
}

void PlaybackGate::page_closed() {
  const std::lock_guard lock(mutex_);
  --pages_;
  last_closed_ = Clock::now();
}

bool PlaybackGate::paused() {
  const std::lock_guard lock(mutex_);
  return holds();
}

int PlaybackGate::pages() const {
  const std::lock_guard lock(mutex_);
  return pages_;
}

bool PlaybackGate::holds() {
  if (paused_ && watched_ && pages_ == 0 && Clock::now() - last_closed_ > grace) {
    paused_ = false;
    steps_ = 0;
  }
  return paused_;
}

void PlaybackGate::wait(const std::atomic<bool>* stop) {
  constexpr auto look = std::chrono::milliseconds(50);  // at `stop`, which a signal sets
  std::unique_lock lock(mutex_);
  while (holds() && steps_ == 0 && !(stop && *stop)) changed_.wait_for(lock, look);
  steps_ = std::max(0, steps_ - 1);
}

}  // namespace dkp_slam::viewer

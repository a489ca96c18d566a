#include "dkp_slam/system/pace.h"

#include <algorithm>
#include <thread>

namespace dkp_slam {

Pace::Clock::time_point Pace::due(double timestamp) {
  if (!started_) {
    started_ = true;
    start_ = Clock::now();
    first_timestamp_ = timestamp;
  }
  const std::chrono::duration<double> since((timestamp - first_timestamp_) / rate_);
  return start_ + std::chrono::duration_cast<Clock::duration>(since);
}

void Pace::wait_for(double timestamp, const std::atomic<bool>* stop) {
  constexpr auto look = std::chrono::milliseconds(50);  // at `stop`
  const Clock::time_point moment = due(timestamp);
  while (!(stop && *stop) && Clock::now() < moment) {
    std::this_thread::sleep_until(std::min(moment, Clock::now() + look));
  }
}

}  // namespace dkp_slam

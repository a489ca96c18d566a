#pragma once

#include <atomic>
#include <chrono>

namespace dkp_slam {

/// When frames are due that are played by their time stamps.
class Pace {
 public:
  /// So many times as fast as they were recorded; above 0.
  explicit Pace(double rate) : rate_(rate) {}
  /// The first frame is due at once. Returns early when `stop`, which may be null, is set.
  void wait_for(double timestamp, const std::atomic<bool>* stop);

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point due(double timestamp);

  const double rate_;
  bool started_ = false;
  Clock::time_point start_;
  double first_timestamp_ = 0.0;
};

}  // namespace dkp_slam

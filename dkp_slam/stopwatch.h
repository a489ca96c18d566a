#pragma once

#include <chrono>

namespace dkp_slam {

/// Wall time since it was made or last restarted.
class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }
  /// Milliseconds so far; starts again.
  double lap_ms() {
    const double elapsed = ms();
    start_ = std::chrono::steady_clock::now();
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace dkp_slam

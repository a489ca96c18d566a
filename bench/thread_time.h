#pragma once

#include <ctime>

namespace dkp_slam::bench {

/// Time of this thread on a processor, so that what else the machine does counts little.
class ThreadTime {
 public:
  /// Milliseconds since it was made.
  double ms() const { return now_ms() - start_; }

 private:
  static double now_ms() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
  }
  double start_ = now_ms();
};

}  // namespace dkp_slam::bench

#include "dkp_slam/thread_priority.h"

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace dkp_slam {

void lower_priority() {
#if defined(__linux__)
  constexpr int nice = 10;
  const auto thread = static_cast<id_t>(gettid());
  if (getpriority(PRIO_PROCESS, thread) < nice) setpriority(PRIO_PROCESS, thread, nice);
#endif
}

}  // namespace dkp_slam

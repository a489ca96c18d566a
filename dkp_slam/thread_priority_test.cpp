#include "dkp_slam/thread_priority.h"

#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace dkp_slam {
namespace {

int nice_of_this_thread() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

TEST(LowerPriority, IsOfTheCallingThreadAlone) {
  const int before = nice_of_this_thread();
  int lowered = -1, again = -1;
  std::thread([&] {
    lower_priority();
    lowered = nice_of_this_thread();
    lower_priority();
    again = nice_of_this_thread();
  }).join();
  EXPECT_GE(lowered, 10);
  EXPECT_EQ(again, lowered);
  EXPECT_EQ(nice_of_this_thread(), before);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/system/bounded_queue.h"

#include <chrono>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(BoundedQueue, TheOldestGoesWhereThereIsNoRoom) {
  BoundedQueue<int> queue(2);
  EXPECT_EQ(queue.push_newest(1), 0);
  EXPECT_EQ(queue.push_newest(2), 0);
  EXPECT_EQ(queue.push_newest(3), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), 3);
}

TEST(BoundedQueue, WhatIsOverdueGoesThoughThereIsRoom) {
  BoundedQueue<int> queue(4);
  for (const int item : {1, 2, 3}) queue.push_newest(item);
  EXPECT_EQ(queue.push_newest(4, [](int waiting) { return waiting < 3; }), 2);
  // Only from the front: order is time.
  EXPECT_EQ(queue.push_newest(5, [](int waiting) { return waiting == 4; }), 0);
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 4);
  EXPECT_EQ(queue.pop(), 5);
}

TEST(BoundedQueue, OnceClosedItTakesNothingAndGivesWhatIsLeft) {
  BoundedQueue<int> queue(2);
  queue.push_newest(1);
  queue.close();
  EXPECT_FALSE(queue.push(2));
  queue.push_newest(3);
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_FALSE(queue.pop().has_value());
  EXPECT_FALSE(queue.pop_until(std::chrono::steady_clock::time_point::max()).has_value());
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/mapping/worker.h"

#include <new>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// Doubles a number, once it is let through.
struct Doubler {
  std::atomic<bool> gate{false};
  Worker<int, int> worker{"test", [this](int problem, const std::atomic<bool>& stop) {
                            while (!gate && !stop) std::this_thread::yield();
                            return 2 * problem;
                          }};
};

TEST(WorkerTest, SolvesOneProblemAfterTheOther) {
  Doubler doubler;
  for (int i = 1; i < 4; ++i) {
    doubler.gate = false;
    doubler.worker.submit(i);
    EXPECT_TRUE(doubler.worker.pending());
    EXPECT_FALSE(doubler.worker.finished());
    doubler.gate = true;
    EXPECT_EQ(doubler.worker.take(), 2 * i);
    EXPECT_FALSE(doubler.worker.pending());
  }
}

TEST(WorkerTest, AnAbandonedProblemIsStoppedAndItsSolutionNeverSeen) {
  Doubler doubler;
  doubler.worker.submit(1);
  doubler.worker.abandon();
  EXPECT_FALSE(doubler.worker.pending());
  doubler.worker.submit(2);  // while the first may still be at work
  doubler.gate = true;
  EXPECT_EQ(doubler.worker.take(), 4);
  EXPECT_FALSE(doubler.worker.finished());
}

TEST(WorkerTest, ASolutionThatWaitsCanBeAbandoned) {
  Doubler doubler;
  doubler.gate = true;
  doubler.worker.submit(1);
  while (!doubler.worker.finished()) std::this_thread::yield();
  doubler.worker.abandon();
  EXPECT_FALSE(doubler.worker.finished());
  doubler.worker.submit(5);
  EXPECT_EQ(doubler.worker.take(), 10);
}

TEST(WorkerTest, WhatSolvingThrowsIsThrownWhereItIsTaken) {
  Worker<int, int> worker("test", [](int problem, const std::atomic<bool>&) {
    if (problem == 1) throw std::bad_alloc();
    return problem;
  });
  worker.submit(1);
  EXPECT_THROW(worker.take(), std::bad_alloc);
  EXPECT_FALSE(worker.pending());
  worker.submit(1);
  while (!worker.finished()) std::this_thread::yield();
  worker.abandon();
  worker.submit(3);
  EXPECT_EQ(worker.take(), 3);
}

TEST(WorkerTest, ItsEndStopsWhatIsUnderWay) {
  std::atomic<bool> at_work{false}, told{false};
  {
    Worker<int, int> worker("test", [&](int, const std::atomic<bool>& stop) {
      at_work = true;
      while (!stop) std::this_thread::yield();
      told = true;
      return 0;
    });
    worker.submit(1);
    while (!at_work) std::this_thread::yield();
  }
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/system/playback.h"

#include <atomic>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "tests/support/noise_frames.h"

namespace dkp_slam {
namespace {

using testing::NoiseSource;

SlamConfig config(bool realtime = false) {
  SlamConfig made;
  made.camera = testing::noise_camera();
  made.dynamics.mode = DynamicsMode::off;
  made.realtime = realtime;
  return made;
}

TEST(Playback, EveryFrameHasItsResultInOrder) {
  for (const bool one_at_a_time : {false, true}) {
    NoiseSource source(15);
    Slam slam(config());
    std::vector<int> indices;
    play(source, slam, {.one_at_a_time = one_at_a_time},
         [&](const FrameResult& r) { indices.push_back(r.index); });
    ASSERT_EQ(indices.size(), 15U);
    for (int i = 0; i < 15; ++i) EXPECT_EQ(indices[std::size_t(i)], i);
    EXPECT_EQ(slam.counters().answered, 15);
  }
}

TEST(Playback, OneAtATimeReadsAFrameOnlyWhenTheOneBeforeHasItsResult) {
  int results = 0;
  NoiseSource source(8, [&](int index) { EXPECT_EQ(results, index); });
  Slam slam(config());
  play(source, slam, {.one_at_a_time = true}, [&](const FrameResult&) { ++results; });
  EXPECT_EQ(results, 8);
}

TEST(Playback, ASourcesErrorComesAfterTheFramesBeforeIt) {
  for (const bool realtime : {false, true}) {
    NoiseSource source(9, [](int index) {
      if (index == 5) throw Error("the disk is gone");
    });
    Slam slam(config(realtime));
    int frames = 0;
    try {
      play(source, slam, {}, [&](const FrameResult&) { ++frames; });
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "the disk is gone");
    }
    EXPECT_EQ(frames + slam.counters().dropped, 5);
    EXPECT_NO_THROW(slam.trajectories());  // what there is can be saved
  }
}

TEST(Playback, WhatTheReceiverThrowsEndsTheRun) {
  NoiseSource source(100000);
  Slam slam(config());
  int calls = 0;
  EXPECT_THROW(play(source, slam, {},
                    [&](const FrameResult&) {
                      if (++calls == 3) throw Error("the disk is full");
                    }),
               Error);
  EXPECT_LT(slam.counters().fed, 100);
}

TEST(Playback, StopsWhenAsked) {
  for (const bool realtime : {false, true}) {
    std::atomic<bool> stop{false};
    NoiseSource source(100000, [&](int index) {
      if (index == 5) stop = true;
    });
    Slam slam(config(realtime));
    play(source, slam, {.rate = realtime ? 1.0 : 0.0, .stop = &stop});
    EXPECT_LE(slam.counters().fed, 6);  // 1000 s when played by the clock
  }
}

TEST(Playback, ByTheClockNothingIsFedBeforeItsTime) {
  NoiseSource source(6);
  Slam slam(config(true));
  const auto start = std::chrono::steady_clock::now();
  play(source, slam, {.rate = 0.5});
  // Frames are 10 ms apart and played at half the pace: the sixth is due after 100 ms.
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(100));
  EXPECT_EQ(slam.counters().fed, 6);
}

}  // namespace
}  // namespace dkp_slam

#include "viewer/playback_gate.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace dkp_slam::viewer {
namespace {

using namespace std::chrono_literals;

/// Goes through the gate again and again.
class Player {
 public:
  explicit Player(PlaybackGate& gate)
      : thread_([this, &gate] {
          while (!stop_) {
            gate.wait(&stop_);
            if (!stop_) ++passed_;
            std::this_thread::sleep_for(1ms);
          }
        }) {}
  ~Player() {
    stop_ = true;
    thread_.join();
  }
  int passed() const { return passed_; }
  /// Until it stands still.
  int settled() const {
    int before = -1;
    while (before != passed_) {
      before = passed_;
      std::this_thread::sleep_for(100ms);
    }
    return before;
  }
  bool goes_on(int from) const {
    for (int i = 0; i < 1000 && passed_ <= from; ++i) std::this_thread::sleep_for(10ms);
    return passed_ > from;
  }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<int> passed_{0};
  std::thread thread_;
};

TEST(PlaybackGate, HoldsStepsAndLetsGo) {
  PlaybackGate gate;
  gate.page_opened();
  gate.pause(true);
  const Player player(gate);
  const int held = player.settled();
  gate.step();
  gate.step();
  EXPECT_TRUE(player.goes_on(held + 1));
  EXPECT_EQ(player.settled(), held + 2);
  EXPECT_TRUE(gate.paused());
  gate.pause(false);
  EXPECT_TRUE(player.goes_on(held + 2));
}

TEST(PlaybackGate, APauseEndsWhenNoPageIsLeft) {
  PlaybackGate gate;
  gate.page_opened();
  gate.page_opened();
  gate.pause(true);
  const Player player(gate);
  const int held = player.settled();
  gate.page_closed();
  EXPECT_EQ(player.settled(), held);
  gate.page_closed();
  EXPECT_TRUE(player.goes_on(held));
  EXPECT_FALSE(gate.paused());
}

TEST(PlaybackGate, APauseOutlivesAReload) {
  PlaybackGate gate;
  gate.page_opened();
  gate.pause(true);
  gate.page_closed();
  gate.page_opened();
  std::this_thread::sleep_for(PlaybackGate::grace + 100ms);
  EXPECT_TRUE(gate.paused());
}

TEST(PlaybackGate, BeginsPausedWhereToldTo) {
  PlaybackGate gate(true);
  const Player player(gate);
  std::this_thread::sleep_for(PlaybackGate::grace + 100ms);
  EXPECT_EQ(player.passed(), 0);
  gate.page_opened();
  EXPECT_EQ(player.settled(), 0);
  gate.pause(false);
  EXPECT_TRUE(player.goes_on(0));
}

TEST(PlaybackGate, AStopEndsTheWaiting) {
  PlaybackGate gate;
  gate.page_opened();
  gate.pause(true);
  const std::atomic<bool> stop{true};
  gate.wait(&stop);  // returns
}

}  // namespace
}  // namespace dkp_slam::viewer

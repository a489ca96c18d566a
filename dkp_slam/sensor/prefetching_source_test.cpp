#include "dkp_slam/sensor/prefetching_source.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// Frames 0, 1, 2, ... of which every fifth is skipped; throws instead of frame `fail_at`.
class CountingSource : public RgbdSource {
 public:
  CountingSource(int frames, int fail_at, std::atomic<int>* reads)
      : frames_(frames), fail_at_(fail_at), reads_(reads) {}
  std::string description() const override { return "counting"; }
  std::optional<std::size_t> size() const override { return frames_; }
  std::size_t skipped() const override { return skipped_; }
  std::optional<RgbdFrame> read() override {
    ++*reads_;
    if (next_ == fail_at_) throw Error("frame fails");
    if (next_ % 5 == 4) {
      ++skipped_;
      ++next_;
    }
    if (next_ >= frames_) return std::nullopt;
    RgbdFrame frame;
    frame.index = next_++;
    return frame;
  }

 private:
  int frames_, fail_at_;
  std::atomic<int>* reads_;
  int next_ = 0;
  std::size_t skipped_ = 0;
};

TEST(PrefetchingSource, SameFramesInTheSameOrder) {
  std::atomic<int> reads = 0;
  PrefetchingSource source(std::make_unique<CountingSource>(100, -1, &reads), 3);
  EXPECT_EQ(source.description(), "counting");
  EXPECT_EQ(source.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    if (i % 5 == 4) continue;
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    // Counts up to this frame, however far the thread is ahead.
    EXPECT_EQ(source.skipped(), static_cast<std::size_t>((i + 1) / 5));
  }
  EXPECT_FALSE(source.read());
  EXPECT_FALSE(source.read());
  EXPECT_EQ(source.skipped(), 20U);
}

TEST(PrefetchingSource, ReadsAheadNoFurtherThanItsCapacity) {
  std::atomic<int> reads = 0;
  PrefetchingSource source(std::make_unique<CountingSource>(100, -1, &reads), 3);
  while (reads < 4) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(reads, 4);  // three in the queue, one in the hand
}

TEST(PrefetchingSource, ForwardsAnExceptionAfterTheFramesBeforeIt) {
  std::atomic<int> reads = 0;
  PrefetchingSource source(std::make_unique<CountingSource>(100, 3, &reads), 8);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(source.read());
  EXPECT_THROW(source.read(), Error);
  EXPECT_THROW(source.read(), Error);
}

TEST(PrefetchingSource, StopsInTheMiddle) {
  std::atomic<int> reads = 0;
  for (int i = 0; i < 50; ++i) {
    PrefetchingSource source(std::make_unique<CountingSource>(1000, -1, &reads), 2);
    if (i % 2 == 0) source.read();
  }
  EXPECT_LT(reads, 1000);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/system/front_end.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// Small pictures of noise, 10 ms apart. `on_read` is called before each with the frame's index.
class FakeSource : public RgbdSource {
 public:
  explicit FakeSource(std::size_t frames, std::function<void(int)> on_read = {})
      : frames_(frames), on_read_(std::move(on_read)) {}
  std::string description() const override { return "fake"; }
  std::optional<std::size_t> size() const override { return frames_; }
  std::size_t skipped() const override { return skipped_; }
  std::optional<RgbdFrame> read() override {
    if (next_ == frames_) return std::nullopt;
    const int index = static_cast<int>(next_++);
    if (on_read_) on_read_(index);
    if (index % 4 == 3) ++skipped_;
    RgbdFrame frame;
    frame.index = index;
    frame.timestamp = 100.0 + 0.01 * index;
    frame.colour.create(120, 160, CV_8UC3);
    cv::RNG(static_cast<std::uint64_t>(index) + 1).fill(frame.colour, cv::RNG::UNIFORM, 0, 256);
    frame.depth = cv::Mat::ones(120, 160, CV_32F);
    return frame;
  }

 private:
  const std::size_t frames_;
  const std::function<void(int)> on_read_;
  std::size_t next_ = 0, skipped_ = 0;
};

/// One detection a frame whose class is the frame's index. `on_detect` is called before.
class FakeDetector : public Detector {
 public:
  explicit FakeDetector(std::function<void(int)> on_detect = {})
      : on_detect_(std::move(on_detect)) {}
  std::string name() const override { return "fake"; }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    if (on_detect_) on_detect_(frame.index);
    Detection d;
    d.class_id = frame.index;
    return {d};
  }

 private:
  const std::function<void(int)> on_detect_;
};

TEST(FrontEnd, EveryFrameInOrderWithItsOwnFeaturesAndDetections) {
  FrontEnd front_end(std::make_unique<FakeSource>(20), std::make_unique<FakeDetector>(), {});
  OrbExtractor extractor{OrbOptions()};
  for (int i = 0; i < 20; ++i) {
    const auto frame = front_end.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->frame.index, i);
    ASSERT_EQ(frame->detections.size(), 1U);
    EXPECT_EQ(frame->detections[0].class_id, i);
    EXPECT_EQ(frame->grey.type(), CV_8UC1);
    EXPECT_EQ(frame->orb.descriptors, extractor.extract(frame->grey).descriptors);
  }
  EXPECT_FALSE(front_end.next());
  EXPECT_FALSE(front_end.next());  // and again
  EXPECT_EQ(front_end.skipped_frames(), 5U);
  EXPECT_EQ(front_end.dropped_frames(), 0);
}

TEST(FrontEnd, WithoutADetectorFramesCarryNoDetections) {
  FrontEnd front_end(std::make_unique<FakeSource>(3), nullptr, {});
  int frames = 0;
  while (const auto frame = front_end.next()) {
    EXPECT_TRUE(frame->detections.empty());
    ++frames;
  }
  EXPECT_EQ(frames, 3);
}

TEST(FrontEnd, ADetectorThatThrowsIsNotCalledAgain) {
  struct NoStandardException {};
  const std::function<void()> failures[] = {[] { throw Error("out of memory"); },
                                            [] { throw NoStandardException(); }};
  for (const auto& fail : failures) {
    std::atomic<int> calls{0};
    auto detector = std::make_unique<FakeDetector>([&](int index) {
      ++calls;
      if (index == 7) fail();
    });
    FrontEnd front_end(std::make_unique<FakeSource>(12), std::move(detector), {});
    for (int i = 0; i < 12; ++i) {
      const auto frame = front_end.next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->frame.index, i);
      EXPECT_EQ(frame->detections.size(), i < 7 ? 1U : 0U);
    }
    EXPECT_FALSE(front_end.next());
    EXPECT_EQ(front_end.detector_failures(), 1);
    EXPECT_EQ(calls, 8);
  }
}

TEST(FrontEnd, ASourcesErrorComesAfterTheFramesBeforeIt) {
  for (const bool realtime : {false, true}) {
    auto source = std::make_unique<FakeSource>(9, [](int index) {
      if (index == 5) throw Error("the disk is gone");
    });
    FrontEndOptions options;
    options.realtime = realtime;
    FrontEnd front_end(std::move(source), nullptr, options);
    int frames = 0;
    try {
      while (front_end.next()) ++frames;
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "the disk is gone");
    }
    EXPECT_EQ(frames + front_end.dropped_frames(), 5);
    EXPECT_EQ(front_end.skipped_frames(), 1U);  // frame 3's
    EXPECT_THROW(front_end.next(), Error);
  }
}

TEST(FrontEnd, AnImageThatCannotBeWorkedOnIsAnErrorToo) {
  class GreySource : public FakeSource {
   public:
    GreySource() : FakeSource(3) {}
    std::optional<RgbdFrame> read() override {
      auto frame = FakeSource::read();
      if (frame && frame->index == 1) frame->colour = cv::Mat();
      return frame;
    }
  };
  FrontEnd front_end(std::make_unique<GreySource>(), nullptr, {});
  EXPECT_TRUE(front_end.next());
  EXPECT_THROW(front_end.next(), cv::Exception);
}

TEST(FrontEnd, AnErrorOfTheSourceComesTooLateAfterOneOfTheFeatures) {
  class GreySource : public FakeSource {
   public:
    using FakeSource::FakeSource;
    std::optional<RgbdFrame> read() override {
      auto frame = FakeSource::read();
      if (frame) frame->colour = cv::Mat();
      return frame;
    }
  };
  // Relaxed: ThreadSanitizer must not take the flag for what orders the two threads.
  std::atomic<bool> failed{false}, last{false};
  auto source = std::make_unique<GreySource>(3, [&](int index) {
    if (index == 0) return;
    while (!failed.load(std::memory_order_relaxed)) std::this_thread::yield();
    last.store(true, std::memory_order_relaxed);
    throw Error("the disk is gone");
  });
  FrontEnd front_end(std::move(source), nullptr, {});
  EXPECT_THROW(front_end.next(), cv::Exception);
  failed.store(true, std::memory_order_relaxed);
  while (!last.load(std::memory_order_relaxed)) std::this_thread::yield();
  for (int i = 0; i < 100; ++i) EXPECT_THROW(front_end.next(), cv::Exception);
}

TEST(FrontEnd, EndsInTheMiddleWithoutReadingOn) {
  for (const bool realtime : {false, true}) {
    for (const int taken : {0, 1, 5}) {
      std::atomic<int> last_read{-1};
      FrontEndOptions options;
      options.realtime = realtime;
      {
        FrontEnd front_end(
            std::make_unique<FakeSource>(100000, [&](int index) { last_read = index; }),
            std::make_unique<FakeDetector>(), options);
        for (int i = 0; i < taken; ++i) ASSERT_TRUE(front_end.next());
      }
      EXPECT_LT(last_read, 50000);  // 500 s when played by the clock
    }
  }
}

TEST(FrontEnd, InRealTimeASlowDetectorIsNotWaitedFor) {
  // It comes back only once all frames have been taken, so waiting for it would never end.
  std::atomic<bool> all_taken{false};
  auto detector = std::make_unique<FakeDetector>([&](int) { all_taken.wait(false); });
  FrontEndOptions options;
  options.realtime = true;
  FrontEnd front_end(std::make_unique<FakeSource>(10), std::move(detector), options);
  int frames = 0, last = -1;
  while (const auto frame = front_end.next()) {
    EXPECT_GT(frame->frame.index, last);
    last = frame->frame.index;
    EXPECT_TRUE(frame->detections.empty());
    ++frames;
  }
  EXPECT_EQ(frames + front_end.dropped_frames(), 10);
  EXPECT_EQ(last, 9);  // the newest is never the one dropped
  all_taken = true;
  all_taken.notify_all();
}

}  // namespace
}  // namespace dkp_slam

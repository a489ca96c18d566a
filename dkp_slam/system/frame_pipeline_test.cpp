#include "dkp_slam/system/frame_pipeline.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "tests/support/noise_frames.h"

namespace dkp_slam {
namespace {

using testing::IndexDetector;
using testing::noise_frame;

constexpr bool live = true, offline = false;

TEST(FramePipeline, EveryFrameInOrderWithItsOwnFeaturesAndDetections) {
  FramePipeline pipeline(std::make_unique<IndexDetector>(), {}, offline);
  OrbExtractor extractor{OrbOptions()};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(pipeline.push(noise_frame(i)));
    const auto frame = pipeline.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->frame.index, i);
    EXPECT_TRUE(frame->detections.answered);
    EXPECT_EQ(frame->detections.timestamp, frame->frame.timestamp);
    ASSERT_EQ(frame->detections.detections.size(), 1U);
    EXPECT_EQ(frame->detections.detections[0].class_id, i);
    EXPECT_EQ(frame->grey.type(), CV_8UC1);
    EXPECT_EQ(frame->orb.descriptors, extractor.extract(frame->grey).descriptors);
  }
  pipeline.close_input();
  EXPECT_FALSE(pipeline.next());
  EXPECT_FALSE(pipeline.next());  // and again
  EXPECT_EQ(pipeline.dropped_frames(), 0);
}

TEST(FramePipeline, WithoutADetectorThereIsNoAnswer) {
  FramePipeline pipeline(nullptr, {}, offline);
  for (int i = 0; i < 3; ++i) {
    pipeline.push(noise_frame(i));
    const auto frame = pipeline.next();
    ASSERT_TRUE(frame);
    EXPECT_FALSE(frame->detections.answered);
    EXPECT_TRUE(frame->detections.detections.empty());
  }
}

/// Looks at every third frame.
class RareDetector : public IndexDetector {
 public:
  bool looks_at(const RgbdFrame& frame) override { return frame.index % 3 == 0; }
};

TEST(FramePipeline, AFrameThatTheDetectorDoesNotLookAtHasNoAnswer) {
  FramePipeline pipeline(std::make_unique<RareDetector>(), {}, offline);
  for (int i = 0; i < 7; ++i) {
    pipeline.push(noise_frame(i));
    const auto frame = pipeline.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->detections.answered, i % 3 == 0);
    EXPECT_EQ(frame->detections.detections.size(), i % 3 == 0 ? 1U : 0U);
    if (i % 3 != 0) {
      EXPECT_EQ(frame->detection_ms, 0.0);
    }
  }
}

TEST(FramePipeline, ADetectorThatThrowsIsNotCalledAgain) {
  struct NoStandardException {};
  const std::function<void()> failures[] = {[] { throw Error("out of memory"); },
                                            [] { throw NoStandardException(); }};
  for (const auto& fail : failures) {
    std::atomic<int> calls{0};
    auto detector = std::make_unique<IndexDetector>([&](int index) {
      ++calls;
      if (index == 7) fail();
    });
    FramePipeline pipeline(std::move(detector), {}, offline);
    for (int i = 0; i < 12; ++i) {
      pipeline.push(noise_frame(i));
      const auto frame = pipeline.next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->frame.index, i);
      EXPECT_EQ(frame->detections.answered, i < 7);
    }
    EXPECT_EQ(pipeline.detector_failures(), 1);
    EXPECT_EQ(calls, 8);
  }
}

TEST(FramePipeline, AnImageThatCannotBeWorkedOnIsAnErrorAfterTheFramesBefore) {
  FramePipeline pipeline(nullptr, {}, offline);
  pipeline.push(noise_frame(0));
  pipeline.push(RgbdFrame());
  EXPECT_TRUE(pipeline.next());
  EXPECT_THROW(pipeline.next(), cv::Exception);
  EXPECT_THROW(pipeline.next(), cv::Exception);
  EXPECT_FALSE(pipeline.push(noise_frame(2)));  // and nobody waits for room that never comes
}

/// Throws where nobody expects it, as everything may when memory runs out.
class NamelessDetector : public Detector {
 public:
  std::string name() const override { throw std::bad_alloc(); }
  std::vector<Detection> detect(const RgbdFrame&) override { throw Error("no detections"); }
};

TEST(FramePipeline, WhatEndsTheDetectorsThreadIsAnError) {
  for (const bool mode : {offline, live}) {
    FramePipeline pipeline(std::make_unique<NamelessDetector>(), {}, mode);
    pipeline.push(noise_frame(0));
    const auto take_all = [&] {
      while (pipeline.next()) {
      }
    };
    EXPECT_THROW(take_all(), std::bad_alloc);
    EXPECT_THROW(pipeline.next(), std::bad_alloc) << "and again";
    EXPECT_FALSE(pipeline.push(noise_frame(1)));
  }
}

TEST(FramePipeline, EndsInTheMiddle) {
  for (const bool mode : {live, offline}) {
    for (const int taken : {0, 1}) {
      FramePipeline pipeline(std::make_unique<IndexDetector>(), {}, mode);
      for (int i = 0; i < 2; ++i) pipeline.push(noise_frame(i));
      for (int i = 0; i < taken; ++i) ASSERT_TRUE(pipeline.next());
      pipeline.stop();
      EXPECT_FALSE(pipeline.next());
    }
  }
}

TEST(FramePipeline, LiveASlowDetectorIsNotWaitedFor) {
  // It comes back only once all frames have been taken, so waiting for it would never end.
  std::atomic<bool> all_taken{false};
  auto detector = std::make_unique<IndexDetector>([&](int) { all_taken.wait(false); });
  FramePipeline pipeline(std::move(detector), {}, live);
  for (int i = 0; i < 10; ++i) {
    pipeline.push(noise_frame(i));
    const auto frame = pipeline.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->frame.index, i);
    EXPECT_FALSE(frame->detections.answered);
  }
  EXPECT_EQ(pipeline.dropped_frames(), 0);
  all_taken = true;
  all_taken.notify_all();
}

TEST(FramePipeline, LiveALateAnswerSaysWhichImageItIsOf) {
  std::atomic<bool> go_on{false};
  auto detector = std::make_unique<IndexDetector>([&](int) { go_on.wait(false); });
  FramePipeline pipeline(std::move(detector), {}, live);
  pipeline.push(noise_frame(0));
  ASSERT_TRUE(pipeline.next());  // the detector has begun with it, or will
  go_on = true;
  go_on.notify_all();
  bool told = false;
  for (int i = 1; i < 5000 && !told; ++i) {
    pipeline.push(noise_frame(i));
    const auto frame = pipeline.next();
    ASSERT_TRUE(frame);
    if (!frame->detections.answered) continue;
    told = true;
    ASSERT_EQ(frame->detections.detections.size(), 1U);
    const int of = frame->detections.detections[0].class_id;
    EXPECT_EQ(frame->detections.timestamp, noise_frame(of).timestamp);
  }
  EXPECT_TRUE(told);
}

TEST(FramePipeline, LiveAFrameIntoWhichSomebodyStepsWaitsForItsOwnAnswer) {
  const auto slow = [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(8)); };
  FramePipeline pipeline(std::make_unique<IndexDetector>(slow), {}, live);
  for (int i = 0; i < 12; ++i) {
    RgbdFrame frame = noise_frame(i);
    frame.timestamp = 100.0 + i / 30.0;
    frame.depth = cv::Mat(frame.colour.size(), CV_32FC1, cv::Scalar(3.0));
    if (i >= 6) frame.depth.colRange(0, frame.depth.cols / 4).setTo(1.0);
    pipeline.push(frame);
    const auto prepared = pipeline.next();
    ASSERT_TRUE(prepared);
    if (i > 0 && i != 6) continue;
    ASSERT_TRUE(prepared->detections.answered) << i;
    EXPECT_EQ(prepared->detections.timestamp, frame.timestamp) << i;
  }
}

TEST(FramePipeline, LiveSomebodyWhoStepsInEndsTheDetectorsRest) {
  FramePipeline pipeline(std::make_unique<IndexDetector>([](int) {}), {}, live);
  const auto frame_of = [](int i) {
    RgbdFrame frame = noise_frame(i);
    frame.timestamp = 100.0 + i / 30.0;
    frame.colour = frame.colour(cv::Rect(0, 0, 160, 120)).clone();  // features take no time
    frame.depth = cv::Mat(frame.colour.size(), CV_32FC1, cv::Scalar(3.0));
    return frame;
  };
  // Nobody takes these: the detector learns that there is too little time, and rests longer than
  // somebody who steps in is waited for.
  int i = 0;
  while (pipeline.dropped_frames() < 20) pipeline.push(frame_of(++i));
  while (pipeline.next()->frame.index < i) continue;
  for (int n = 0; n < 10; ++n) {
    const RgbdFrame after_gap = frame_of(i += 40);
    pipeline.push(after_gap);
    auto prepared = pipeline.next();
    ASSERT_TRUE(prepared && prepared->startling);
    EXPECT_EQ(prepared->detections.timestamp, after_gap.timestamp) << n;
    RgbdFrame nearer = frame_of(++i);
    nearer.depth.colRange(0, nearer.depth.cols / 4).setTo(1.0);
    pipeline.push(nearer);
    prepared = pipeline.next();
    ASSERT_TRUE(prepared && prepared->startling);
    EXPECT_EQ(prepared->detections.timestamp, nearer.timestamp) << n;
  }
}

TEST(FramePipeline, LiveTheOldestFramesAreDropped) {
  FramePipeline pipeline(nullptr, {}, live);
  for (int i = 0; i < 200; ++i) pipeline.push(noise_frame(i));
  pipeline.close_input();
  int frames = 0, last = -1;
  while (const auto frame = pipeline.next()) {
    EXPECT_GT(frame->frame.index, last);
    last = frame->frame.index;
    ++frames;
  }
  EXPECT_EQ(last, 199);  // the newest is never the one dropped
  EXPECT_EQ(frames + pipeline.dropped_frames(), 200);
  EXPECT_GT(pipeline.dropped_frames(), 0);
}

}  // namespace
}  // namespace dkp_slam

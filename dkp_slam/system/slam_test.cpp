#include "dkp_slam/system/slam.h"

#include <atomic>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/system/playback.h"
#include "tests/support/noise_frames.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;
using testing::noise_frame;
using testing::Recording;
using ::testing::ThrowsMessage;

/// A still room looked at by a moving camera, rendered once.
const Recording& room() {
  static const Recording made("static_room", 30, 0, 2);
  return made;
}

SlamConfig room_config() {
  SlamConfig config;
  config.camera = room().camera;
  config.dynamics.mode = DynamicsMode::off;
  return config;
}

SlamConfig noise_config(bool realtime = false) {
  SlamConfig config;
  config.camera = testing::noise_camera();
  config.dynamics.mode = DynamicsMode::off;
  config.realtime = realtime;
  return config;
}

TEST(Door, FramesInPosesOut) {
  Slam slam(room_config());
  std::vector<FrameResult> results;
  for (const RgbdFrame& frame : room().frames) {
    slam.feed(frame);
    while (auto result = slam.poll()) results.push_back(*result);
  }
  slam.finish();
  while (auto result = slam.poll()) results.push_back(*result);
  ASSERT_EQ(results.size(), room().frames.size());
  Trajectory live;
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].index, static_cast<int>(i));
    EXPECT_EQ(results[i].state, TrackingState::tracking);
    ASSERT_TRUE(results[i].localised);
    EXPECT_GT(results[i].latency_ms, 0.0);
    live.push_back({results[i].timestamp, results[i].world_from_camera});
  }
  EXPECT_LT(room().error(live), 0.010);
  EXPECT_LT(room().error(slam.trajectory()), 0.010);
  EXPECT_EQ(slam.counters().fed, 30);
  EXPECT_EQ(slam.counters().answered, 30);
}

TEST(Door, WaitsForTheNextResultAndNotForWhatNeverComes) {
  Slam slam(noise_config());
  EXPECT_FALSE(slam.wait());
  for (int i = 0; i < 3; ++i) slam.feed(noise_frame(i));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(slam.wait()->index, i);
  EXPECT_FALSE(slam.wait());
  slam.finish();
  slam.finish();  // once more does nothing
  EXPECT_FALSE(slam.wait());
}

TEST(Door, RefusesWhatIsNoFrameAndGoesOn) {
  Slam slam(noise_config());
  slam.feed(noise_frame(0));
  const auto refused = [&](RgbdFrame frame, const char* why) {
    EXPECT_THAT([&] { slam.feed(frame); }, ThrowsMessage<Error>(HasSubstr(why)));
  };
  RgbdFrame frame = noise_frame(1);
  frame.colour = cv::Mat();
  refused(frame, "frame 1: its colour image");
  frame = noise_frame(1);
  frame.colour = cv::Mat::zeros(120, 160, CV_8UC1);
  refused(frame, "its colour image is not of 3 channels of 8 bits");
  frame = noise_frame(1);
  frame.depth = cv::Mat::zeros(120, 160, CV_16UC1);
  refused(frame, "its depth image is not of 32-bit floats");
  frame = noise_frame(1);
  frame.colour = cv::Mat::zeros(60, 80, CV_8UC3);
  refused(frame, "its colour image is 80 x 60 pixels, the camera 160 x 120");
  frame = noise_frame(1);
  frame.depth = cv::Mat::zeros(60, 80, CV_32FC1);
  refused(frame, "its depth image is 80 x 60 pixels, its colour image 160 x 120");
  refused(noise_frame(0), "is not after the last frame's 100.000000");
  frame = noise_frame(1);
  frame.timestamp = std::numeric_limits<double>::quiet_NaN();
  refused(frame, "its time stamp is no number");
  slam.feed(noise_frame(1));
  slam.finish();
  EXPECT_EQ(slam.counters().answered, 2);
  EXPECT_THROW(slam.feed(noise_frame(2)), Error);
}

TEST(Door, TakesAMaskWithTheImageInModeMasksAlone) {
  const auto refused = [](Slam& slam, const cv::Mat& mask, const char* why) {
    RgbdFrame frame = noise_frame(0);
    frame.mask = mask;
    EXPECT_THAT([&] { slam.feed(frame); }, ThrowsMessage<Error>(HasSubstr(why)));
  };
  const cv::Mat mask = cv::Mat::zeros(120, 160, CV_8UC1);
  Slam off(noise_config());
  refused(off, mask, "frame 0: it has a mask, which mode off does not use; set mode masks");
  SlamConfig config = noise_config();
  config.dynamics.mode = DynamicsMode::masks;
  Slam slam(config);
  refused(slam, cv::Mat::zeros(60, 80, CV_8UC1),
          "its mask is 80 x 60 pixels, its colour image 160");
  refused(slam, cv::Mat::zeros(120, 160, CV_32SC1), "its mask is not of one channel of 8 bits");
  // Half of the view moves; the driver's buffer is used again at once. Then nobody says anything,
  // and the mask is carried on.
  std::vector<uchar> buffer(mask.total(), 0);
  cv::Mat borrowed(mask.size(), CV_8UC1, buffer.data());
  borrowed.colRange(0, 80) = 1;
  RgbdFrame frame = noise_frame(0);
  frame.mask = borrowed;
  slam.feed(frame);
  std::fill(buffer.begin(), buffer.end(), uchar{0});
  slam.feed(noise_frame(1));
  for (int i = 0; i < 2; ++i) {
    const auto result = slam.wait();
    EXPECT_GT(result->removed_features, 0);
    EXPECT_LT(result->removed_features, result->features);
  }
}

TEST(Door, CountsFramesThatHaveNoIndex) {
  Slam slam(noise_config());
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = noise_frame(i);
    frame.index = 0;
    slam.feed(std::move(frame));
    EXPECT_EQ(slam.wait()->index, i);
  }
}

TEST(Door, PixelsThatAreSomebodyElsesAreCopied) {
  const auto path_with = [](bool borrowed) {
    Slam slam(room_config());
    const RgbdFrame& first = room().frames.front();
    std::vector<uchar> colour(first.colour.total() * 3);
    std::vector<float> depth(first.depth.total());
    for (const RgbdFrame& frame : room().frames) {
      RgbdFrame fed = frame;
      if (borrowed) {
        fed.colour = cv::Mat(frame.colour.size(), CV_8UC3, colour.data());
        fed.depth = cv::Mat(frame.depth.size(), CV_32FC1, depth.data());
        frame.colour.copyTo(fed.colour);
        frame.depth.copyTo(fed.depth);
      }
      slam.feed(std::move(fed));
      // The driver's buffer is used again at once.
      std::fill(colour.begin(), colour.end(), uchar{0});
      std::fill(depth.begin(), depth.end(), 0.0F);
    }
    slam.finish();
    return slam.trajectory();
  };
  const Trajectory own = path_with(false), borrowed = path_with(true);
  ASSERT_EQ(own.size(), 30U);
  ASSERT_EQ(borrowed.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(own[i].world_from_camera.translation, borrowed[i].world_from_camera.translation);
  }
}

TEST(Door, TheMapIsNobodysUntilTheEnd) {
  Slam slam(noise_config());
  slam.feed(noise_frame(0));
  EXPECT_THROW(slam.map(), Error);
  EXPECT_THROW(slam.trajectory(), Error);
  slam.finish();
  EXPECT_EQ(slam.trajectory().size(), slam.trajectories().empty() ? 0U : 1U);
}

TEST(Door, MayBeLeftInTheMiddle) {
  for (const bool realtime : {false, true}) {
    Slam slam(noise_config(realtime), std::make_unique<testing::IndexDetector>());
    for (int i = 0; i < 3; ++i) slam.feed(noise_frame(i));
  }
}

TEST(Door, LiveWhatIsTooFastIsDroppedAndCounted) {
  Slam slam(noise_config(true));
  for (int i = 0; i < 300; ++i) slam.feed(noise_frame(i));
  slam.finish();
  int results = 0, last = -1;
  while (const auto result = slam.poll()) {
    EXPECT_GT(result->index, last);
    last = result->index;
    ++results;
  }
  EXPECT_EQ(last, 299);
  EXPECT_EQ(results + slam.counters().dropped, 300);
}

/// Counts what it is told.
struct Recorder : SlamObserver {
  std::vector<int> frames;
  std::vector<KeyframeSnapshot> keyframes;
  std::vector<TrackingChange> lost, found;
  std::set<int> map_keyframes, map_landmarks;
  int maps_told = 0;

  void on_frame(const std::shared_ptr<const FrameSnapshot>& s) override {
    frames.push_back(s->result.index);
    EXPECT_EQ(s->keypoints.size(), std::size_t(s->result.features));
    EXPECT_EQ(s->landmarks.size(), s->keypoints.size());
    EXPECT_EQ(s->frame.index, s->result.index);
  }
  void on_keyframe(const KeyframeSnapshot& k) override { keyframes.push_back(k); }
  void on_map(const MapChange& change) override {
    ++maps_told;
    for (const auto& k : change.keyframes) map_keyframes.insert(k.id);
    for (const int id : change.removed_keyframes) map_keyframes.erase(id);
    for (const auto& l : change.landmarks) map_landmarks.insert(l.id);
    for (const int id : change.removed_landmarks) map_landmarks.erase(id);
  }
  void on_lost(const TrackingChange& change) override { lost.push_back(change); }
  void on_found(const TrackingChange& change) override { found.push_back(change); }
};

/// The room with a hand over the lens from frame 10 to 15 (exclusive).
RgbdFrame covered(const RgbdFrame& frame) {
  RgbdFrame seen = frame;
  if (frame.index < 10 || frame.index >= 15) return seen;
  seen.colour = cv::Mat(frame.colour.size(), CV_8UC3, cv::Scalar::all(8));
  seen.depth = cv::Mat::zeros(frame.depth.size(), CV_32F);
  return seen;
}

TEST(Observers, AreToldOfEverythingInOrder) {
  const auto recorder = std::make_shared<Recorder>();
  Slam slam(room_config());
  slam.add_observer(recorder, {.delivery = Delivery::every, .map = true, .map_interval = 0.0});
  int keyframes = 0;
  for (const RgbdFrame& frame : room().frames) {
    slam.feed(covered(frame));
    keyframes += slam.wait()->keyframe;
  }
  EXPECT_THROW(slam.add_observer(recorder), Error);
  slam.finish();
  ASSERT_EQ(recorder->frames.size(), 30U);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(recorder->frames[std::size_t(i)], i);
  EXPECT_EQ(int(recorder->keyframes.size()), keyframes);
  EXPECT_GT(recorder->keyframes.front().landmarks, 100);
  ASSERT_EQ(recorder->lost.size(), 1U);
  EXPECT_EQ(recorder->lost[0].frame_index, 10);
  ASSERT_EQ(recorder->found.size(), 1U);
  EXPECT_GE(recorder->found[0].frame_index, 15);
  EXPECT_NEAR(recorder->found[0].lost_for,
              recorder->found[0].timestamp - recorder->lost[0].timestamp, 1e-9);
  // Changes of the map, put together, are the map.
  EXPECT_GT(recorder->maps_told, 2);
  const std::vector<int> kept = slam.map().keyframes_in(0), landmarks = slam.map().landmarks();
  EXPECT_EQ(recorder->map_keyframes, std::set<int>(kept.begin(), kept.end()));
  EXPECT_EQ(recorder->map_landmarks, std::set<int>(landmarks.begin(), landmarks.end()));
  EXPECT_EQ(slam.counters().observer_exceptions, 0);
  EXPECT_EQ(slam.counters().observer_drops, 0);
}

TEST(Observers, ASlowOneNeverHoldsTheRunUpAndGetsTheNewest) {
  // Each of its calls ends only when the run has: a system that waited for it would wait for ever.
  struct Slow : Recorder {
    std::atomic<bool> run_is_over{false};
    void on_frame(const std::shared_ptr<const FrameSnapshot>& s) override {
      run_is_over.wait(false);
      Recorder::on_frame(s);
    }
    void on_keyframe(const KeyframeSnapshot& k) override {
      run_is_over.wait(false);
      Recorder::on_keyframe(k);
    }
    void on_map(const MapChange& change) override {
      run_is_over.wait(false);
      Recorder::on_map(change);
    }
  };
  const auto slow = std::make_shared<Slow>();
  const auto quick = std::make_shared<Recorder>();
  Slam slam(room_config());
  slam.add_observer(slow, {.map = true, .map_interval = 0.0});
  slam.add_observer(quick, {.delivery = Delivery::every});
  for (const RgbdFrame& frame : room().frames) {
    slam.feed(frame);
    ASSERT_TRUE(slam.wait());
  }
  slow->run_is_over = true;
  slow->run_is_over.notify_all();
  slam.finish();
  EXPECT_EQ(quick->frames.size(), 30U);  // nor does it hold up another
  ASSERT_FALSE(slow->frames.empty());
  // The one it was busy with, and the newest (perhaps of before the last result came, and after).
  EXPECT_LE(slow->frames.size(), 3U);
  EXPECT_EQ(slow->frames.back(), 29);
  EXPECT_GE(slam.counters().observer_drops, 27);
  // It missed frames; of the map it knows everything.
  const std::vector<int> landmarks = slam.map().landmarks();
  EXPECT_EQ(slow->map_landmarks, std::set<int>(landmarks.begin(), landmarks.end()));
}

TEST(Observers, OneThatThrowsEndsNothing) {
  struct Throwing : SlamObserver {
    void on_frame(const std::shared_ptr<const FrameSnapshot>&) override { throw Error("no"); }
    void on_keyframe(const KeyframeSnapshot&) override { throw 1; }
    void on_map(const MapChange&) override { throw std::string("what is this"); }
  };
  Slam slam(room_config()), alone(room_config());
  slam.add_observer(std::make_shared<Throwing>(),
                    {.delivery = Delivery::every, .map = true, .map_interval = 0.0});
  play(*room().play(), slam);
  play(*room().play(), alone);
  EXPECT_GT(slam.counters().observer_exceptions, 30);
  const Trajectory with = slam.trajectory(), without = alone.trajectory();
  ASSERT_EQ(with.size(), 30U);
  ASSERT_EQ(without.size(), 30U);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].world_from_camera.translation, without[i].world_from_camera.translation);
  }
}

TEST(Observers, LiveNobodyWaitsForOneThatWantsEveryFrame) {
  struct Stuck : SlamObserver {
    std::atomic<bool> go{false};
    void on_frame(const std::shared_ptr<const FrameSnapshot>&) override { go.wait(false); }
  };
  const auto stuck = std::make_shared<Stuck>();
  Slam slam(noise_config(true));
  slam.add_observer(stuck, {.delivery = Delivery::every, .inbox = 3});
  int fed = 0;
  // Until more has been answered than its inbox holds.
  while (slam.counters().answered < 10) slam.feed(noise_frame(fed++));
  stuck->go = true;
  stuck->go.notify_all();
  slam.finish();
  EXPECT_GT(slam.counters().observer_drops, 0);
}

}  // namespace
}  // namespace dkp_slam

// Losing the place and finding it again, and closing loops, by the whole system on whole sequences.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

/// Frames of a sequence that are played, from one to another (exclusive).
struct Segment {
  int from = 0, to = 0;
  double pause = 0.0;    ///< seconds that pass before it, more than from frame to frame
  bool covered = false;  ///< a hand lies over the lens: no picture, no depth
};

/// Plays segments of a sequence one after the other, as if the camera had recorded them so: indices
/// count on, and so does time. Keeps the true path, in the new time, if given one in the old.
class SplicedSource : public RgbdSource {
 public:
  /// The sequence from this frame on.
  using Opener = std::function<std::unique_ptr<RgbdSource>(int first)>;
  SplicedSource(Opener open, std::vector<Segment> segments, Trajectory truth, Trajectory* spliced)
      : open_(std::move(open)),
        segments_(std::move(segments)),
        truth_(std::move(truth)),
        spliced_(spliced) {}

  std::string description() const override { return "spliced"; }
  std::optional<std::size_t> size() const override { return std::nullopt; }
  std::size_t skipped() const override { return 0; }

  std::optional<RgbdFrame> read() override {
    while (segment_ < segments_.size()) {
      const Segment& s = segments_[segment_];
      if (!source_) source_ = open_(s.from);
      std::optional<RgbdFrame> frame = source_->read();
      if (!frame || played_ == s.to - s.from) {
        source_.reset();
        played_ = 0;
        ++segment_;
        continue;
      }
      if (played_++ == 0) begin(s, frame->timestamp);
      if (s.covered) {
        frame->colour = cv::Mat(frame->colour.size(), CV_8UC3, cv::Scalar::all(8));
        frame->depth = cv::Mat::zeros(frame->depth.size(), CV_32F);
      }
      frame->index = next_index_++;
      frame->timestamp += offset_;
      time_ = frame->timestamp;
      return frame;
    }
    return std::nullopt;
  }

 private:
  void begin(const Segment& s, double first) {
    constexpr double frame_time = 1.0 / 30.0;
    offset_ = next_index_ == 0 ? 0.0 : time_ + frame_time + s.pause - first;
    const double last = first + (s.to - s.from) * frame_time;
    for (const StampedPose& p : truth_) {
      const double moment = p.timestamp + offset_;
      if (p.timestamp < first || p.timestamp > last) continue;
      if (!spliced_->empty() && moment <= spliced_->back().timestamp) continue;
      spliced_->push_back({moment, p.world_from_camera});
    }
  }

  const Opener open_;
  const std::vector<Segment> segments_;
  const Trajectory truth_;
  Trajectory* const spliced_;
  std::unique_ptr<RgbdSource> source_;
  std::size_t segment_ = 0;
  int played_ = 0;       // of the segment
  double offset_ = 0.0;  // seconds from the sequence's time to this one's
  int next_index_ = 0;
  double time_ = 0.0;
};

struct SplicedOutcome {
  std::vector<char> localised;  ///< per frame
  double error = 0.0;           ///< metres
  std::size_t loops = 0;

  /// Frames that were not localised, from one to another (exclusive).
  int lost(std::size_t from, std::size_t to) const {
    int count = 0;
    for (std::size_t i = from; i < to; ++i) count += !localised.at(i);
    return count;
  }
};

SplicedOutcome run(const SplicedSource::Opener& open, const std::vector<Segment>& segments,
                   const Camera& camera, const Trajectory& truth) {
  SlamConfig options;
  options.camera = camera;
  options.dynamics.mode = DynamicsMode::off;
  Slam slam(options);
  Trajectory spliced;
  SplicedOutcome outcome;
  SplicedSource source(open, segments, truth, &spliced);
  play(source, slam, {},
       [&](const FrameResult& result) { outcome.localised.push_back(result.localised); });
  outcome.loops = slam.loops().size();
  outcome.error = absolute_error(spliced, slam.trajectory()).statistics.rmse;
  return outcome;
}

/// A static room.
class SyntheticRelocalisation : public ::testing::Test {
 protected:
  static SplicedOutcome play(const std::vector<Segment>& segments) {
    static const testing::Recording room("static_room", 80);  // as long as slam_test.cpp needs it
    return run([](int first) { return room.play(static_cast<std::size_t>(first)); }, segments,
               room.camera, room.truth);
  }
};

TEST_F(SyntheticRelocalisation, AfterAJumpBack) {
  const SplicedOutcome outcome = play({{0, 60}, {10, 40}});
  EXPECT_EQ(outcome.lost(0, 60), 0);
  EXPECT_EQ(outcome.lost(63, 90), 0);
  EXPECT_LT(outcome.error, 0.010);
}

TEST_F(SyntheticRelocalisation, ElsewhereAfterTheLensWasCovered) {
  const SplicedOutcome outcome = play({{0, 50}, {50, 60, 0.0, true}, {15, 35, 2.0}});
  EXPECT_EQ(outcome.lost(50, 60), 10);
  EXPECT_EQ(outcome.lost(63, 80), 0);
  EXPECT_LT(outcome.error, 0.010);
}

class RealRelocalisation : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("DKP_SLAM_DATA");
    if (!data) GTEST_SKIP() << "DKP_SLAM_DATA names no folder of real sequences";
    data_ = data;
  }
  SplicedOutcome play(const std::vector<Segment>& segments,
                      const std::string& name = "fr1_xyz") const {
    const fs::path folder = data_ / name;
    const Camera camera = load_camera(DKP_SLAM_CONFIG_FOLDER "/tum_fr1.yaml");
    const auto open = [&](int first) {
      TumOptions options;
      options.first_frame = static_cast<std::size_t>(first);
      return open_tum_folder(folder, camera, options);
    };
    return run(open, segments, camera, read_trajectory(folder / "groundtruth.txt"));
  }
  fs::path data_;
};

TEST_F(RealRelocalisation, AfterTwoSecondsWithoutFrames) {
  const SplicedOutcome outcome = play({{0, 150}, {210, 300, 2.0}});
  EXPECT_EQ(outcome.lost(0, 150), 0);
  EXPECT_EQ(outcome.lost(153, 240), 0);
  EXPECT_LT(outcome.error, 0.012);
}

TEST_F(RealRelocalisation, AfterTwoSecondsUnderAHand) {
  const SplicedOutcome outcome = play({{0, 150}, {150, 210, 0.0, true}, {210, 300}});
  EXPECT_EQ(outcome.lost(150, 210), 60);
  EXPECT_EQ(outcome.lost(213, 300), 0);
  EXPECT_LT(outcome.error, 0.012);
}

TEST_F(RealRelocalisation, AfterAJumpAcrossTheSequence) {
  const SplicedOutcome outcome = play({{0, 400}, {100, 200}});
  EXPECT_EQ(outcome.lost(0, 400), 0);
  EXPECT_EQ(outcome.lost(403, 500), 0);
  EXPECT_LT(outcome.error, 0.012);
}

TEST_F(RealRelocalisation, LoopsPutRightWhatPeopleHavePulledAway) {
  // With nothing removed people drag the camera along, and it comes back to where it was. The error
  // is 0.247 m where loops stay open, and 0.13 m where they are closed: what was seen of people
  // alone stays where they have dragged it.
  const SplicedOutcome outcome = play({{0, 788}}, "composite_xyz_walking");
  EXPECT_GE(outcome.loops, 1U);
  EXPECT_LT(outcome.error, 0.18);
}

}  // namespace
}  // namespace dkp_slam

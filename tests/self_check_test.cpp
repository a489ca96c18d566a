// What a frame's result says of itself, against the truth.

#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/changed_source.h"
#include "tests/support/exact_boxes.h"
#include "tests/support/honesty.h"
#include "tests/support/recording.h"
#include "tests/support/run.h"

namespace dkp_slam {
namespace {

using testing::ChangedSource;
using testing::ExactBoxes;
using testing::Honesty;
using testing::Outcome;
using testing::Recording;

Outcome run_changed(const Recording& room, ChangedSource::Change change) {
  return testing::run(std::make_unique<ChangedSource>(room.play(), std::move(change)), nullptr,
                      room.camera, DynamicsMode::dkp_plus);
}

struct Walk {
  const char* scenario;
  std::size_t frames, first_frame;
};
std::ostream& operator<<(std::ostream& out, const Walk& walk) { return out << walk.scenario; }

class SelfCheckOnWalks : public ::testing::TestWithParam<Walk> {};

TEST_P(SelfCheckOnWalks, TheCovarianceIsHonest) {
  const Recording room(GetParam().scenario, GetParam().frames, GetParam().first_frame, 2);
  const Outcome outcome = testing::run(room.play(), testing::motion_detector(room.camera),
                                       room.camera, DynamicsMode::dkp_plus);
  const Honesty honesty = testing::honesty_of(outcome.frames, room.truth);
  EXPECT_EQ(honesty.localised, static_cast<int>(GetParam().frames));
  EXPECT_LE(honesty.over_three_sigma, 0.02 * honesty.localised);
  EXPECT_LT(honesty.largest_error, 0.06);  // 0.12 in the last where he took the camera with him
  // Who claims nothing is always honest.
  EXPECT_LT(honesty.median_sigma, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Synthetic, SelfCheckOnWalks,
                         // In the last the map is made on somebody, who then walks away.
                         ::testing::Values(Walk{"walking_rpy", 90, 150},
                                           Walk{"walking_halfsphere", 60, 90},
                                           Walk{"covered_start", 135, 0}),
                         [](const auto& info) { return info.param.scenario; });

class GeneratedScenario : public ::testing::TestWithParam<Walk> {};

TEST_P(GeneratedScenario, NoFrameIsCalledLocalisedThatIsFarOff) {
  const Recording room(GetParam().scenario, GetParam().frames, GetParam().first_frame, 2);
  const Outcome outcome = testing::run(room.play(), testing::motion_detector(room.camera),
                                       room.camera, DynamicsMode::dkp_plus);
  for (const FrameResult& f : outcome.frames) {
    SCOPED_TRACE(f.index);
    EXPECT_TRUE(!f.localised || f.map == 0);  // one map, whose errors are laid over the truth below
    // Who is carried by the measured motion says so at once.
    const bool by_motion = f.localised && f.tracked_landmarks == 0;
    EXPECT_EQ(by_motion, f.localised && f.quality.since_map_seen > 0.0);
    EXPECT_TRUE(!by_motion || f.quality.since_map_seen <= 1.0);
  }
  EXPECT_LT(testing::honesty_of(outcome.frames, room.truth).largest_error, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Synthetic, GeneratedScenario,
                         // Five people; somebody fills the view; a chair is pushed; the lamps go
                         // off and on; frames are missing.
                         ::testing::Values(Walk{"crowd", 45, 90}, Walk{"close_up", 45, 275},
                                           Walk{"moved_furniture", 45, 245},
                                           Walk{"lights", 65, 110}, Walk{"dropped_frames", 60, 60}),
                         [](const auto& info) { return info.param.scenario; });

TEST(SelfCheck, TheShareOfPeopleIsThatOfTheView) {
  const Recording room("walking_static", 60, 90, 2);
  const Outcome outcome = testing::run(room.play(), std::make_unique<ExactBoxes>(room), room.camera,
                                       DynamicsMode::dkp_plus);
  double largest = 0.0, off = 0.0;
  for (std::size_t i = 5; i < room.frames.size(); ++i) {
    const double truth =
        cv::countNonZero(room.truths[i].mask) / double(room.truths[i].mask.total());
    largest = std::max(largest, truth);
    off += std::abs(outcome.frames[i].quality.people_share - truth) / double(room.frames.size());
  }
  EXPECT_GT(largest, 0.15);
  EXPECT_LT(off, 0.05);
}

TEST(SelfCheck, ACoveredLensIsSaidAtOnceAndForHowLong) {
  const Recording room("static_room", 60, 0, 2);
  constexpr int from = 20, to = 40;
  const Outcome outcome = run_changed(room, [](RgbdFrame& frame) {
    if (frame.index < from || frame.index >= to) return;
    frame.colour = cv::Mat(frame.colour.size(), CV_8UC3, cv::Scalar::all(8));
    frame.depth = cv::Mat::zeros(frame.depth.size(), CV_32F);
  });
  const double last_seen = outcome.frames[from - 1].timestamp;
  for (const FrameResult& f : outcome.frames) {
    SCOPED_TRACE(f.index);
    const bool covered = f.index >= from && f.index < to;
    EXPECT_EQ(f.localised, !covered);
    EXPECT_NEAR(f.quality.since_map_seen, covered ? f.timestamp - last_seen : 0.0, 1e-9);
    EXPECT_EQ(std::isfinite(f.quality.position_sigma()), !covered);
    EXPECT_EQ(f.quality.people_share, 0.0);
  }
}

TEST(SelfCheck, ACameraThatStoodStillForAMinuteKnowsWhereItIs) {
  const Recording room("static_room", 60, 0, 2);
  constexpr int from = 30;
  constexpr double minute = 60.0;
  Trajectory truth = room.truth;
  for (std::size_t i = from; i < truth.size(); ++i) truth[i].timestamp += minute;
  const Outcome outcome = run_changed(room, [](RgbdFrame& frame) {
    if (frame.index >= from) frame.timestamp += minute;
  });
  EXPECT_EQ(outcome.lost(), std::vector<int>());
  const Honesty honesty = testing::honesty_of(outcome.frames, truth);
  EXPECT_EQ(honesty.over_three_sigma, 0);
  EXPECT_LT(honesty.largest_error, 0.02);
}

TEST(SelfCheck, BeforeThereIsAMapNothingIsKnown) {
  const PoseQuality quality;
  EXPECT_EQ(quality.since_map_seen, std::numeric_limits<double>::infinity());
  EXPECT_EQ(quality.position_sigma(), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace dkp_slam

// What a robot is told when its camera sees the room no more, and when it does again.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/support/changed_source.h"
#include "tests/support/honesty.h"
#include "tests/support/recording.h"
#include "tests/support/run.h"

namespace dkp_slam {
namespace {

using testing::ChangedSource;
using testing::Outcome;
using testing::Recording;

constexpr double promised = 0.3;     // seconds until a lost view is said
constexpr double most_error = 0.2;   // metres, of a frame that is called localised
constexpr int gone = 20, back = 44;  // frames that see something else, the second exclusive
constexpr int until_found = 5;       // frames

const Recording& room() {
  static const Recording recording("static_room", 60, 0, 2);
  return recording;
}

cv::Mat random_image(const cv::Size& size, int index, int most) {
  cv::Mat image(size, CV_8UC3);
  cv::RNG(index + 1).fill(image, cv::RNG::UNIFORM, 0, most);
  return image;
}

cv::Mat no_depth(const RgbdFrame& frame) { return cv::Mat::zeros(frame.depth.size(), CV_32F); }

/// Something lies on the lens.
void cover(RgbdFrame& frame) {
  frame.colour = cv::Mat(frame.colour.size(), CV_8UC3, cv::Scalar::all(8));
  frame.depth = no_depth(frame);
}

/// A palm before the lens, nearer than depth is measured.
void hold_a_hand_before(RgbdFrame& frame) {
  cv::Mat palm = random_image(frame.colour.size(), 0, 255);
  cv::GaussianBlur(palm, palm, {0, 0}, 12.0);
  frame.colour = 0.5 * palm + cv::Scalar(60, 80, 120);
  frame.depth = no_depth(frame);
}

/// No light, but the noise of the colour sensor; depth has a light of its own.
void switch_the_light_off(RgbdFrame& frame) {
  frame.colour = random_image(frame.colour.size(), frame.index, 6);
}

void blind(RgbdFrame& frame) {
  frame.colour = cv::Mat(frame.colour.size(), CV_8UC3, cv::Scalar::all(255));
}

/// A broken cable.
void send_noise(RgbdFrame& frame) {
  frame.colour = random_image(frame.colour.size(), frame.index, 256);
  cv::Mat depth(frame.depth.size(), CV_32F);
  cv::RNG(frame.index + 1).fill(depth, cv::RNG::UNIFORM, 0.5, 6.0);
  frame.depth = depth;
}

/// Carried off into a flat that the map knows nothing of.
void go_elsewhere(RgbdFrame& frame) {
  static const Recording flat("flat_loop", back - gone, 0, 2);
  const RgbdFrame& there = flat.frames[static_cast<std::size_t>(frame.index - gone)];
  frame.colour = there.colour;
  frame.depth = there.depth;
}

struct Interruption {
  const char* name;
  void (*happen)(RgbdFrame&);
};
std::ostream& operator<<(std::ostream& out, const Interruption& i) { return out << i.name; }

Outcome play_room(ChangedSource::Change change) {
  return testing::run(std::make_unique<ChangedSource>(room().play(), std::move(change)),
                      testing::motion_detector(room().camera), room().camera,
                      DynamicsMode::dkp_plus);
}

/// The largest error of a frame that is called localised; all are in one map.
double largest_error(const Outcome& outcome, const Trajectory& truth) {
  for (const FrameResult& f : outcome.frames) EXPECT_TRUE(!f.localised || f.map == 0) << f.index;
  return testing::honesty_of(outcome.frames, truth).largest_error;
}

class LostView : public ::testing::TestWithParam<Interruption> {};

TEST_P(LostView, IsSaidInTimeAndSoIsThatItIsBack) {
  const Outcome outcome = play_room([](RgbdFrame& frame) {
    if (frame.index >= gone && frame.index < back) GetParam().happen(frame);
  });
  const double in_time = outcome.frames[gone].timestamp + promised;
  for (const FrameResult& f : outcome.frames) {
    SCOPED_TRACE(f.index);
    if (f.index < gone || f.index >= back + until_found) {
      EXPECT_TRUE(f.localised);
    } else if (f.index < back) {
      EXPECT_EQ(f.tracked_landmarks, 0);
      EXPECT_FALSE(f.localised && f.timestamp >= in_time);
    }
  }
  EXPECT_LT(largest_error(outcome, room().truth), most_error);
}

INSTANTIATE_TEST_SUITE_P(
    Synthetic, LostView,
    ::testing::Values(Interruption{"covered", cover}, Interruption{"hand", hold_a_hand_before},
                      Interruption{"dark", switch_the_light_off}, Interruption{"blinded", blind},
                      Interruption{"noise", send_noise}, Interruption{"elsewhere", go_elsewhere}),
    [](const auto& info) { return info.param.name; });

TEST(LostView, AJumpWithinTheRoomIsFoundOutOrSaid) {
  const Recording walk("walking_halfsphere", 60, 90, 2);
  constexpr std::size_t jump = 40, to = 0;
  Trajectory truth = walk.truth;
  for (std::size_t i = jump; i < truth.size(); ++i) {
    truth[i].world_from_camera = walk.truth[i - jump + to].world_from_camera;
  }
  const auto change = [&](RgbdFrame& frame) {
    const auto i = static_cast<std::size_t>(frame.index) - walk.frames.front().index;
    if (i < jump) return;
    frame.colour = walk.frames[i - jump + to].colour;
    frame.depth = walk.frames[i - jump + to].depth;
  };
  const Outcome outcome =
      testing::run(std::make_unique<ChangedSource>(walk.play(), change),
                   testing::motion_detector(walk.camera), walk.camera, DynamicsMode::dkp_plus);
  EXPECT_LT(largest_error(outcome, truth), most_error);
  for (std::size_t i = jump + until_found; i < truth.size(); ++i) {
    EXPECT_TRUE(outcome.frames[i].localised) << i;
  }
}

}  // namespace
}  // namespace dkp_slam

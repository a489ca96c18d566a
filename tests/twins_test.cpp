#include <algorithm>
#include <cstddef>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/exact_boxes.h"
#include "tests/support/recording.h"
#include "tests/support/run.h"

namespace dkp_slam {
namespace {

using testing::ExactBoxes;
using testing::motion_detector;
using testing::Outcome;
using testing::Recording;
using testing::run;

struct Twin {
  std::string scenario;
  std::size_t frames, first_frame;
  double bound;        ///< of the ATE, metres
  bool people_matter;  ///< they walk, so that mode off misses the bound
};
std::ostream& operator<<(std::ostream& out, const Twin& twin) { return out << twin.scenario; }

class Twins : public ::testing::TestWithParam<Twin> {};

// Half the width, which is rendered in a third of the time and makes every error twice as large.
// From the time on when somebody has got up and walks up to the camera.
constexpr int divisor = 2;
constexpr std::size_t first_walk = 90;

TEST_P(Twins, ExactBoxesAndMotionDetector) {
  const Twin& twin = GetParam();
  const Recording room(twin.scenario, twin.frames, twin.first_frame, divisor);
  for (const bool exact : {true, false}) {
    SCOPED_TRACE(exact ? "exact boxes" : "motion detector");
    const Outcome outcome =
        run(room.play(), exact ? std::make_unique<ExactBoxes>(room) : motion_detector(room.camera),
            room.camera, DynamicsMode::dkp_plus);
    EXPECT_EQ(outcome.lost(), std::vector<int>());
    EXPECT_LT(room.error(outcome.path), twin.bound);
  }
  if (!twin.people_matter) return;
  // A bound that a system which knows nothing of people keeps would tell nothing.
  const Outcome off = run(room.play(), nullptr, room.camera, DynamicsMode::off);
  EXPECT_GT(room.error(off.path), twin.bound) << "mode off";
}

// Between what is measured with exact boxes and with the motion detector, and what mode off comes
// to (in brackets). Other seeds of the system change the static twins' figures by 0.0002 at most,
// another placing of the renderer's rays those of the others by up to 0.002.
INSTANTIATE_TEST_SUITE_P(
    Synthetic, Twins,
    ::testing::Values(
        Twin{"walking_xyz", 60, 210, 0.010, true},                // 0.0014, 0.0033 (0.0406)
        Twin{"walking_rpy", 90, 150, 0.011, true},                // 0.0074, 0.0052 (0.0206)
        Twin{"walking_halfsphere", 60, first_walk, 0.010, true},  // 0.0023, 0.0020 (0.1038)
        Twin{"walking_static", 60, first_walk, 0.0035, true},     // 0.0013, 0.0023 (0.0064)
        Twin{"sitting_static", 45, 0, 0.004, false},              // 0.0014, 0.0013
        Twin{"sitting_xyz", 45, 0, 0.005, false}),                // 0.0015, 0.0022
    [](const auto& info) { return info.param.scenario; });

TEST(TwinsWithoutDetections, ForASecond) {
  const Recording room("walking_halfsphere", 75, first_walk, divisor);
  constexpr int from = 25, to = 55;
  const Outcome outcome = run(room.play(), std::make_unique<ExactBoxes>(room, from, to),
                              room.camera, DynamicsMode::dkp_plus);
  EXPECT_EQ(outcome.lost(), std::vector<int>());
  for (int i = from; i < to; ++i) EXPECT_EQ(outcome.frames[std::size_t(i)].detections, 0);
  EXPECT_LT(room.error(outcome.path), 0.012);  // measured: 0.0071
}

TEST(TwinsFromTheFirstFrameOn, SomebodyFillsMostOfTheView) {
  constexpr std::size_t frames = 100;  // then he passes so near that three quarters are hidden
  const Recording room("covered_start", frames, 0, divisor);
  double covered = 0.0;
  for (std::size_t i = 0; i < 60; ++i) covered += cv::mean(room.truths[i].mask)[0] / 255.0 / 60;
  ASSERT_GT(covered, 0.55);
  for (const bool exact : {true, false}) {
    SCOPED_TRACE(exact ? "exact boxes" : "motion detector");
    const Outcome outcome =
        run(room.play(), exact ? std::make_unique<ExactBoxes>(room) : motion_detector(room.camera),
            room.camera, DynamicsMode::dkp_plus);
    EXPECT_EQ(outcome.lost(), std::vector<int>());
    EXPECT_EQ(outcome.path.size(), frames);  // one map, the first one
    EXPECT_LT(room.error(outcome.path), 0.02);
  }
}

}  // namespace
}  // namespace dkp_slam

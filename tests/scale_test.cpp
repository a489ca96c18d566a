#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/geometry/sensor_scale.h"
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

/// The same three seconds, from the time on when somebody gets up and walks up to the camera, as a
/// camera of that size and rate sees them.
Recording walk_seen_by(int width, int height, double rate) {
  Camera camera = resized(SyntheticOptions::default_camera(), width, height);
  camera.frame_rate = rate;
  const auto frames = [rate](double seconds) { return static_cast<std::size_t>(seconds * rate); };
  return Recording("walking_halfsphere", camera, frames(3.0), frames(3.0));
}

struct Errors {
  double exact_boxes = 0.0, motion = 0.0;  ///< ATE, metres
};

/// Without any option. No frame may be lost.
Errors errors_in(const Recording& room) {
  const auto error = [&room](std::unique_ptr<Detector> detector) {
    const Outcome outcome =
        run(room.play(), std::move(detector), room.camera, DynamicsMode::dkp_plus);
    EXPECT_EQ(outcome.lost(), std::vector<int>()) << room.camera.width;
    return room.error(outcome.path);
  };
  return {error(std::make_unique<ExactBoxes>(room)), error(motion_detector(room.camera))};
}

TEST(Scale, ErrorsStayAtOtherSizesAndRates) {
  const Errors usual = errors_in(walk_seen_by(640, 480, 30.0));
  const Errors small = errors_in(walk_seen_by(320, 240, 15.0));
  // Measured: 0.0030 and 0.0012 m, 0.0044 and 0.0027, 0.0020 and 0.0014. With a fourth of the
  // pixels at half the rate what moves is found as well as if it had been told.
  EXPECT_LT(small.exact_boxes, 2.0 * usual.exact_boxes);
  EXPECT_LT(small.motion, 1.5 * usual.exact_boxes);
  const Errors large = errors_in(walk_seen_by(1280, 720, 30.0));
  EXPECT_LT(large.exact_boxes, 1.2 * usual.exact_boxes);
  EXPECT_LT(large.motion, 1.2 * usual.motion);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/sensor/kinect/kinect_clock.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

constexpr std::uint32_t frame = 2'000'000;  // ticks

TEST(KinectClock, GoesOnWhereTheCounterBeginsAnew) {
  KinectClock clock;
  clock.restart(100.0);
  std::uint32_t ticks = 0U - 3 * frame;
  for (int i = 0; i < 3000; ++i, ticks += frame) {
    EXPECT_NEAR(clock.seconds(ticks), 100.0 + i / 30.0, 1e-9);
  }
}

TEST(KinectClock, AnImageMayBeALittleBeforeTheLastOne) {
  KinectClock clock;
  clock.restart(5.0);
  EXPECT_EQ(clock.seconds(10), 5.0);
  EXPECT_NEAR(clock.seconds(10U - frame / 2), 5.0 - 1.0 / 60.0, 1e-9);
  EXPECT_NEAR(clock.seconds(10U + frame), 5.0 + 1.0 / 30.0, 1e-9);
}

TEST(KinectClock, ADeviceThatComesBackIsLaterByTheTimeItWasAway) {
  KinectClock clock;
  clock.restart(5.0);
  clock.seconds(7 * frame);
  clock.restart(9.0);
  EXPECT_EQ(clock.seconds(123), 9.0);
  // Never earlier than what was before, whatever the other clock says.
  clock.seconds(123 + 60 * frame);
  clock.restart(9.5);
  EXPECT_NEAR(clock.seconds(5), 11.1, 1e-9);
}

}  // namespace
}  // namespace dkp_slam

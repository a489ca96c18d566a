#include "bench/dense/room_distance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dkp_slam::bench {
namespace {

using Eigen::Vector3d;

TEST(RoomDistance, IsThatToTheNearestFaceEdgeOrCorner) {
  // Half a metre wide around the origin.
  const RoomDistance distance({box_mesh({0.5, 0.5, 0.5}, nullptr)});
  EXPECT_NEAR(distance({0.0, 0.1, 0.25}), 0.0, 1e-6);
  EXPECT_NEAR(distance({0.1, -0.12, 0.32}), 0.07, 1e-6) << "over a face";
  EXPECT_NEAR(distance({0.1, -0.12, 0.05}), 0.13, 1e-6) << "inside";
  EXPECT_NEAR(distance({0.28, 0.0, 0.29}), 0.05, 1e-6) << "off an edge";
  EXPECT_NEAR(distance({-0.26, -0.27, -0.27}), 0.03, 1e-6) << "off a corner";
  EXPECT_NEAR(distance({0.0, 0.0, 0.51}), 0.26, 1e-6);
  EXPECT_EQ(distance({2.0, 0.0, 0.0}), RoomDistance::farthest);
}

}  // namespace
}  // namespace dkp_slam::bench

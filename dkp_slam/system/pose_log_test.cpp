#include "dkp_slam/system/pose_log.h"

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

TrackedPose pose_number(int i) {
  TrackedPose pose{0.1 * i,      i / 7, testing::pose(0.01 * i, 1.0 / (i + 1), -2.0, 0.001 * i),
                   std::nullopt, 3 * i, i % 5 != 0};
  if (i % 3 > 0) pose.from_previous = testing::pose(1.0 / (i + 2), 0.01 * i, 2.0, 0.002 * i);
  return pose;
}

TEST(PoseLog, GivesBackEveryPoseToTheLastBit) {
  for (const std::size_t in_memory : {1U, 10U, 1000U}) {
    PoseLog log(in_memory);
    for (int round = 0; round < 2; ++round) {  // reading in between disturbs nothing
      for (int i = 0; i < 95; ++i) log.add(pose_number(95 * round + i));
      int next = 0;
      log.for_each([&](const TrackedPose& p) {
        const TrackedPose expected = pose_number(next++);
        EXPECT_EQ(p.timestamp, expected.timestamp);
        EXPECT_EQ(p.reference_keyframe, expected.reference_keyframe);
        EXPECT_EQ(p.camera_from_reference.translation, expected.camera_from_reference.translation);
        EXPECT_EQ(p.camera_from_reference.rotation.coeffs(),
                  expected.camera_from_reference.rotation.coeffs());
        EXPECT_EQ(p.landmarks, expected.landmarks);
        EXPECT_EQ(p.continues, expected.continues);
        ASSERT_EQ(p.from_previous.has_value(), expected.from_previous.has_value());
        if (!p.from_previous) return;
        EXPECT_EQ(p.from_previous->translation, expected.from_previous->translation);
        EXPECT_EQ(p.from_previous->rotation.coeffs(), expected.from_previous->rotation.coeffs());
      });
      EXPECT_EQ(next, 95 * (round + 1));
      EXPECT_EQ(log.size(), static_cast<std::size_t>(next));
    }
  }
}

}  // namespace
}  // namespace dkp_slam

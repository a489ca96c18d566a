#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/dynamics_world.h"

// Missed-detection compensation (paper §3.3) where detections are lost at random and in bursts.
namespace dkp_slam::testing {
namespace {

struct Cost {
  double masked = 0.0;           ///< share of people who walk, unseen, with a mask of IoU >= 0.5
  double removed = 0.0;          ///< of their features, in the frames in which they are unseen
  double removed_if_seen = 0.0;  ///< in the same frames without losses
};

/// `lost` holds a flag per frame.
Cost cost_of(const SyntheticWorld& world, const std::vector<bool>& lost, DynamicsMode mode) {
  DetectionList left = world.boxes;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (lost[i]) left[i].clear();
  }
  const auto results = world.run(mode, left);
  const auto unseen = [&](std::size_t frame) { return static_cast<bool>(lost[frame]); };
  constexpr double least_share = 0.02;  // of the image
  double people = 0.0, masked = 0.0;
  for (const PersonMask& person :
       score_people(world, results, least_share, [&](std::size_t frame, int instance) {
         return unseen(frame) && world.walks(instance);
       })) {
    people += 1.0;
    masked += person.iou >= 0.5 ? 1.0 : 0.0;
  }
  EXPECT_GE(people, 10.0);
  return {masked / people, feature_shares(world, results, unseen).walkers_removed,
          feature_shares(world, world.run(mode, world.boxes), unseen).walkers_removed};
}

constexpr DynamicsMode modes[] = {DynamicsMode::dk, DynamicsMode::dkp_plus};

TEST(CompensationOnTruth, ThreeInTenFramesLost) {
  const SyntheticWorld& world = walking_world();
  cv::RNG random(7);
  std::vector<bool> lost(world.size());
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = random.uniform(0.0, 1.0) < 0.3;
  // Measured: everybody masked, as many features removed as without losses.
  for (const DynamicsMode mode : modes) {
    SCOPED_TRACE(static_cast<int>(mode));
    const Cost cost = cost_of(world, lost, mode);
    EXPECT_GE(cost.masked, 0.9);
    EXPECT_GE(cost.removed, cost.removed_if_seen - 0.05);
  }
}

TEST(CompensationOnTruth, BurstOfASecond) {
  const SyntheticWorld& world = walking_world();
  constexpr std::size_t first = 12, length = 30;
  ASSERT_GT(world.size(), first + length);
  std::vector<bool> lost(world.size(), false);
  std::fill_n(lost.begin() + first, length, true);
  // Measured: the same.
  for (const DynamicsMode mode : modes) {
    SCOPED_TRACE(static_cast<int>(mode));
    const Cost cost = cost_of(world, lost, mode);
    EXPECT_GE(cost.masked, 0.9);
    EXPECT_GE(cost.removed, cost.removed_if_seen - 0.05);
  }
}

}  // namespace
}  // namespace dkp_slam::testing

#include "dkp_slam/sensor/stamp_pairing.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

using Stamps = std::vector<std::pair<double, double>>;

Stamps taken(StampPairing<int>& pairing) {
  Stamps stamps;
  while (auto pair = pairing.next()) stamps.emplace_back(pair->colour_stamp, pair->depth_stamp);
  return stamps;
}

TEST(StampPairing, TakesTheNearestAndWaitsUntilItIsSure) {
  StampPairing<int> pairing(0.02);
  pairing.add_colour(1.000, 0);
  pairing.add_depth(0.985, 1);
  EXPECT_THAT(taken(pairing), IsEmpty());  // a nearer one may come
  pairing.add_depth(1.010, 2);
  EXPECT_THAT(taken(pairing), IsEmpty());  // may belong to the next colour image
  pairing.add_colour(1.033, 3);
  EXPECT_THAT(taken(pairing), IsEmpty());
  pairing.add_depth(1.035, 4);
  EXPECT_THAT(taken(pairing), ElementsAre(Pair(1.000, 1.010)));
  pairing.end();
  EXPECT_THAT(taken(pairing), ElementsAre(Pair(1.033, 1.035)));
  EXPECT_EQ(pairing.unpaired(), 0U);
}

TEST(StampPairing, SameStampsNeedNoWaiting) {
  StampPairing<int> pairing(0.02);
  pairing.add_colour(1.000, 0);
  pairing.add_depth(1.000, 1);
  EXPECT_THAT(taken(pairing), ElementsAre(Pair(1.000, 1.000)));
  pairing.add_colour(2.000, 2);
  EXPECT_FALSE(pairing.next(true));
  pairing.add_depth(2.010, 3);
  EXPECT_FALSE(pairing.next());
  EXPECT_TRUE(pairing.next(true));  // nothing more comes
}

TEST(StampPairing, LeavesADepthImageToTheColourImageThatIsNearer) {
  StampPairing<int> pairing(0.02);
  pairing.add_colour(1.000, 0);
  pairing.add_colour(1.033, 1);
  pairing.add_depth(1.018, 2);
  pairing.end();
  EXPECT_THAT(taken(pairing), ElementsAre(Pair(1.033, 1.018)));
  EXPECT_EQ(pairing.unpaired(), 1U);
}

TEST(StampPairing, LimitIsExclusiveAndWhatGoesBackInTimeIsLeftOut) {
  StampPairing<int> pairing(0.5);
  pairing.add_colour(1.0, 0);
  pairing.add_colour(0.5, 1);
  pairing.add_depth(1.5, 2);
  pairing.end();
  EXPECT_THAT(taken(pairing), IsEmpty());
  EXPECT_EQ(pairing.unpaired(), 1U);
}

TEST(StampPairing, ForgetsTheOldestWhereOneKindIsMissing) {
  StampPairing<int> pairing(0.02);
  const int number = 1000;
  for (int i = 0; i < number; ++i) pairing.add_colour(i, i);
  EXPECT_EQ(pairing.unpaired(), number - StampPairing<int>::most_waiting);
  pairing.add_depth(number - 1, 0);
  pairing.end();
  EXPECT_THAT(taken(pairing), ElementsAre(Pair(number - 1, number - 1)));
}

}  // namespace
}  // namespace dkp_slam

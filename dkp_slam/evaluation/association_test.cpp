#include "dkp_slam/evaluation/association.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/evaluation/statistics.h"

namespace dkp_slam {

bool operator==(const PoseMatch& a, const PoseMatch& b) {
  return a.truth == b.truth && a.estimate == b.estimate;
}

namespace {

using testing::ElementsAre;

Trajectory at(const std::vector<double>& stamps) {
  Trajectory poses;
  for (double stamp : stamps) poses.push_back({stamp, Se3()});
  return poses;
}

TEST(Associate, TakesTheNearestPairFirst) {
  // 1.00 would take 1.01, but 1.008 is nearer to that one and takes it first.
  EXPECT_THAT(associate(at({1.01}), at({1.0, 1.008})), ElementsAre(PoseMatch{0, 1}));
  // The loser then gets what is left within reach.
  EXPECT_THAT(associate(at({0.985, 1.01}), at({1.0, 1.008})),
              ElementsAre(PoseMatch{0, 0}, PoseMatch{1, 1}));
}

TEST(Associate, MatchesOnlyBelowTheMaximalDifference) {
  EXPECT_THAT(associate(at({1.0}), at({1.5}), {.max_difference = 0.5}), ElementsAre());
  EXPECT_THAT(associate(at({1.0}), at({1.5}), {.max_difference = 0.50001}),
              ElementsAre(PoseMatch{0, 0}));
  EXPECT_THAT(associate(at({}), at({1.5})), ElementsAre());
}

TEST(Associate, AddsTheOffsetToTheEstimate) {
  EXPECT_THAT(associate(at({10.0, 11.0}), at({1.0, 2.0}), {.offset = 9.0}),
              ElementsAre(PoseMatch{0, 0}, PoseMatch{1, 1}));
}

TEST(NearestIndex, FindsTheNearestAndTheEnds) {
  const std::vector<double> values = {1.0, 2.0, 4.0, 8.0};
  EXPECT_EQ(nearest_index(values, -5.0), 0U);
  EXPECT_EQ(nearest_index(values, 2.9), 1U);
  EXPECT_EQ(nearest_index(values, 3.1), 2U);
  EXPECT_EQ(nearest_index(values, 4.0), 2U);
  EXPECT_EQ(nearest_index(values, 50.0), 3U);
  // Equally near to 2 and 4: bisection looks at index 2 first.
  EXPECT_EQ(nearest_index(values, 3.0), 2U);
}

TEST(Statistics, OfAnEvenAndAnOddCount) {
  const std::vector<double> even = {4.0, 1.0, 2.0, 3.0};
  EXPECT_DOUBLE_EQ(median(even), 2.5);
  EXPECT_DOUBLE_EQ(summarise(even).rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(summarise(even).deviation, std::sqrt(1.25));
  const std::vector<double> odd = {5.0, 1.0, 3.0};
  EXPECT_DOUBLE_EQ(median(odd), 3.0);
  EXPECT_DOUBLE_EQ(summarise(odd).mean, 3.0);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/feature/descriptor.h"

#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(Descriptor, DistanceCountsDifferingBits) {
  const Descriptor zero{};
  EXPECT_EQ(hamming_distance(zero, zero), 0);
  EXPECT_EQ(hamming_distance(zero, {~0ULL, ~0ULL, ~0ULL, ~0ULL}), 256);
  EXPECT_EQ(hamming_distance(zero, {1, 2, 4, 3}), 5);
}

TEST(Descriptor, NearestTwoAgreesWithSorting) {
  std::mt19937_64 random(7);
  std::vector<Descriptor> pool(200);
  for (Descriptor& d : pool) {
    for (auto& word : d) word = random();
  }
  Descriptor query = pool[42];
  query[0] ^= 0b111;
  std::vector<int> order(pool.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return hamming_distance(query, pool[a]) < hamming_distance(query, pool[b]);
  });
  const NearestTwo all = nearest_two(query, pool);
  EXPECT_EQ(all.best, 42);
  EXPECT_EQ(all.best_distance, 3);
  EXPECT_EQ(all.second, order[1]);
  const std::vector<int> some{5, 9, 100};
  const NearestTwo few = nearest_two(query, pool, some);
  for (int i : some) EXPECT_GE(hamming_distance(query, pool[i]), few.best_distance);
}

TEST(Descriptor, NearestOfNothingIsNothing) { EXPECT_EQ(nearest_two(Descriptor{}, {}).best, -1); }

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/map/id_map.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(IdMap, HoldsWhatAMapHolds) {
  std::mt19937 random(3);
  // Few values of a wide range, many of a narrow one with the same last bits, and ids in a row.
  for (const int step : {1'000'003, 4096, 1}) {
    IdMap<int> ids;
    std::map<int, int> expected;
    for (int i = 0; i < 3000; ++i) {
      const int id = static_cast<int>(random() % 2000U) * step;
      const auto [value, is_new] = ids.insert(id, i);
      EXPECT_EQ(is_new, expected.emplace(id, i).second);
      ++value;
      ++expected[id];
    }
    EXPECT_EQ(ids.size(), expected.size());
    for (int n = 0; n < 2100; ++n) {
      const auto found = expected.find(n * step);
      const int* value = ids.find(n * step);
      ASSERT_EQ(value != nullptr, found != expected.end());
      if (!value) continue;
      EXPECT_EQ(*value, found->second);
    }
  }
}

TEST(IdMap, KnowsNothingAtFirst) {
  const IdMap<int> ids;
  EXPECT_EQ(ids.find(0), nullptr);
  EXPECT_EQ(ids.size(), 0U);
}

TEST(IdSet, TellsNewOnes) {
  IdSet ids;
  EXPECT_TRUE(ids.insert(7));
  EXPECT_FALSE(ids.insert(7));
  EXPECT_TRUE(ids.contains(7));
  EXPECT_FALSE(ids.contains(8));
}

}  // namespace
}  // namespace dkp_slam

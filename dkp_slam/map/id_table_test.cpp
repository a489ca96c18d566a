#include "dkp_slam/map/id_table.h"

#include <map>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

TEST(IdTable, HoldsWhatAMapHolds) {
  IdTable<int> table;
  std::map<int, int> truth;
  std::mt19937 random(7);
  for (int id = 0; id < 3000; ++id) {
    table.set(id, truth[id] = static_cast<int>(random()));
    for (int i = 0; i < 2; ++i) {
      const int gone = static_cast<int>(random() % 3000);
      table.erase(gone);
      truth.erase(gone);
    }
  }
  ASSERT_GT(truth.size(), 100U);
  EXPECT_EQ(table.size(), truth.size());
  std::vector<int> ids;
  for (const auto& [id, value] : truth) {
    ids.push_back(id);
    ASSERT_NE(table.find(id), nullptr);
    EXPECT_EQ(table[id], value);
  }
  EXPECT_EQ(table.ids(), ids);
  for (int id = -1; id < 4000; ++id) EXPECT_EQ(table.find(id) != nullptr, truth.count(id) > 0);
  for (int id = 0; id < 4000; ++id) {
    const auto after = truth.lower_bound(id);
    EXPECT_EQ(table.next(id), after == truth.end() ? -1 : after->first);
  }
}

TEST(IdTable, AnErasedValueIsDestroyedAndReplacedOnesAreToo) {
  const auto value = std::make_shared<int>(1);
  IdTable<std::shared_ptr<int>> table;
  for (const int id : {5, 6, 70}) table.set(id, value);
  table.set(6, nullptr);
  EXPECT_EQ(value.use_count(), 3);
  EXPECT_EQ(table.size(), 3U);
  table.erase(5);
  table.erase(70);
  EXPECT_EQ(value.use_count(), 1);
  EXPECT_EQ(table.ids(), std::vector<int>{6});
}

TEST(IdTable, MemoryFollowsTheValuesNotTheIds) {
  IdTable<std::uint64_t> table;
  std::size_t early = 0;
  for (int id = 0; id < 1000000; ++id) {
    table.set(id, 1);
    if (id % 10000 != 0) table.erase(id - 500);  // a few stay
    if (id == 10000) early = table.memory();
  }
  EXPECT_GE(table.size(), 500U);
  // Two pages of 264 bytes more for every 10000 ids, and an eighth of a byte for each of them; what
  // a vector has in reserve is as much again.
  EXPECT_LT(table.memory() - early, 2 * (100 * 2 * 264 + 1000000 / 8));
}

}  // namespace
}  // namespace dkp_slam

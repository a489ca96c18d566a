#include "dkp_slam/localization/place_bucket.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

std::map<std::int32_t, std::uint32_t> content(const PlaceBucket& bucket) {
  std::map<std::int32_t, std::uint32_t> held;
  for (const auto& slot : bucket.slots())
    EXPECT_TRUE(held.emplace(slot.entry, slot.signature).second);
  return held;
}

TEST(PlaceBucket, HoldsWhatWasPutInAndNotTakenOut) {
  std::mt19937_64 random(7);
  PlaceBucket bucket;
  std::map<std::int32_t, std::uint32_t> expected;
  for (int step = 0; step < 4000; ++step) {
    // It grows in the first half, shrinks in the second.
    const bool grow = random() % 100 < (step < 2000 ? 70U : 30U);
    if (grow || expected.empty()) {
      const auto signature = static_cast<std::uint32_t>(random());
      bucket.insert({signature, step});
      expected[step] = signature;
    } else {
      const auto it =
          std::next(expected.begin(), static_cast<std::ptrdiff_t>(random() % expected.size()));
      bucket.erase(it->first);
      expected.erase(it);
    }
    ASSERT_EQ(content(bucket), expected) << "step " << step;
  }
}

TEST(PlaceBucket, TakesNoMoreThanItNeeds) {
  EXPECT_EQ(sizeof(PlaceBucket), sizeof(void*));
  PlaceBucket bucket;
  EXPECT_EQ(bucket.memory(), 0U);
  for (int i = 0; i < 1000; ++i) bucket.insert({0, i});
  EXPECT_LE(bucket.memory(), 1025 * sizeof(PlaceBucket::Slot));
  for (int i = 0; i < 990; ++i) bucket.erase(i);
  EXPECT_LE(bucket.memory(), 41 * sizeof(PlaceBucket::Slot));
  for (int i = 990; i < 1000; ++i) bucket.erase(i);
  EXPECT_EQ(bucket.memory(), 0U);
}

}  // namespace
}  // namespace dkp_slam

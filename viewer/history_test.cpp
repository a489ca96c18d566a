#include "viewer/history.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam::viewer {
namespace {

using ::testing::ElementsAre;

template <class T>
std::vector<int> frames_of(const ThinnedHistory<T>& history) {
  std::vector<int> frames;
  for (const auto& entry : history.entries()) frames.push_back(entry.frame);
  return frames;
}

TEST(ThinnedHistory, ThinsTheOlderHalfWhenTheBudgetIsUsedUp) {
  ThinnedHistory<int> history(8);
  for (int i = 0; i < 8; ++i) history.add(i, i);
  EXPECT_THAT(frames_of(history), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  history.add(8, 8);
  EXPECT_THAT(frames_of(history), ElementsAre(0, 2, 4, 5, 6, 7, 8));
  for (int i = 9; i < 1000; ++i) history.add(i, i);
  EXPECT_LE(history.used(), 8U);
  EXPECT_EQ(history.entries().front().frame, 0);
  EXPECT_EQ(history.entries().back().frame, 999);
}

TEST(ThinnedHistory, FindsTheFrameOrTheOneBefore) {
  ThinnedHistory<int> history(100);
  for (const int frame : {2, 5, 9}) history.add(frame, 10 * frame, 20);
  EXPECT_EQ(history.used(), 60U);
  EXPECT_EQ(history.at(1), nullptr);
  EXPECT_EQ(history.at(2)->value, 20);
  EXPECT_EQ(history.at(8)->value, 50);
  EXPECT_EQ(history.at(100)->value, 90);
  EXPECT_EQ(history.after(5)->frame, 9);
}

}  // namespace
}  // namespace dkp_slam::viewer

#include "dkp_slam/evaluation/mask_score.h"

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// 100 x 100 pixels with these rectangles inside.
cv::Mat mask_of(const std::vector<cv::Rect>& rectangles) {
  cv::Mat mask(100, 100, CV_8UC1, cv::Scalar(0));
  for (const cv::Rect& rectangle : rectangles) mask(rectangle).setTo(255);
  return mask;
}

TEST(ScoreMask, TheSameMaskScoresOne) {
  const cv::Mat mask = mask_of({{10, 10, 30, 40}});
  const auto scores = score_mask(mask, mask);
  ASSERT_EQ(scores.size(), 1U);
  EXPECT_DOUBLE_EQ(scores[0].share, 0.12);
  EXPECT_DOUBLE_EQ(scores[0].iou, 1.0);
}

TEST(ScoreMask, ShiftedByHalfScoresAThird) {
  const auto scores = score_mask(mask_of({{10, 10, 30, 40}}), mask_of({{25, 10, 30, 40}}));
  ASSERT_EQ(scores.size(), 1U);
  EXPECT_DOUBLE_EQ(scores[0].iou, 1.0 / 3.0);
}

TEST(ScoreMask, IgnoresEstimatedRegionsThatTouchNoTrueOne) {
  const cv::Mat truth = mask_of({{10, 10, 30, 40}});
  const auto scores = score_mask(truth, mask_of({{10, 10, 30, 40}, {70, 60, 25, 25}}));
  ASSERT_EQ(scores.size(), 1U);
  EXPECT_DOUBLE_EQ(scores[0].iou, 1.0);
}

TEST(ScoreMask, CountsAllPiecesThatTouchTheRegion) {
  // Two halves with a one-pixel gap: 30 x 40 less a column of 40.
  const auto scores =
      score_mask(mask_of({{10, 10, 30, 40}}), mask_of({{10, 10, 15, 40}, {26, 10, 14, 40}}));
  ASSERT_EQ(scores.size(), 1U);
  EXPECT_DOUBLE_EQ(scores[0].iou, 1160.0 / 1200.0);
}

TEST(ScoreMask, OneMaskOverTwoPeopleIsChargedOnlyForWhatIsBetweenThem) {
  // Regions of 20 x 50, 10 columns apart, under one mask of 50 x 50: 1000 / (1000 + 500) each.
  const auto scores =
      score_mask(mask_of({{10, 10, 20, 50}, {40, 10, 20, 50}}), mask_of({{10, 10, 50, 50}}));
  ASSERT_EQ(scores.size(), 2U);
  EXPECT_DOUBLE_EQ(scores[0].iou, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores[1].iou, 2.0 / 3.0);
}

TEST(ScoreMask, LeavesOutSmallRegionsAndScoresAMissZero) {
  const cv::Mat truth = mask_of({{10, 10, 30, 40}, {80, 80, 10, 10}});
  const auto scores = score_mask(truth, cv::Mat());
  ASSERT_EQ(scores.size(), 1U) << "the second region has 1% of the image";
  EXPECT_DOUBLE_EQ(scores[0].iou, 0.0);
  EXPECT_EQ(score_mask(truth, cv::Mat(), {.min_region_share = 0.01}).size(), 2U);
  EXPECT_TRUE(score_mask(mask_of({}), truth).empty());
}

TEST(ScoreMask, RejectsOtherTypesAndSizes) {
  const cv::Mat mask = mask_of({});
  EXPECT_THROW(score_mask(cv::Mat(100, 100, CV_32F), mask), Error);
  EXPECT_THROW(score_mask(mask, cv::Mat(100, 100, CV_8UC3)), Error);
  EXPECT_THROW(score_mask(mask, cv::Mat(50, 100, CV_8UC1)), Error);
  EXPECT_THROW(score_mask(cv::Mat(), mask), Error) << "a truth that could not be read";
}

TEST(CountFeatures, SortsByTheTrueMaskAndByWhatWasKept) {
  const cv::Mat truth = mask_of({{10, 10, 30, 40}});
  const std::vector<cv::Point2f> positions = {{9.6F, 10.0F},  {39.4F, 20.0F}, {9.4F, 10.0F},
                                              {39.6F, 20.0F}, {80.0F, 80.0F}, {-3.0F, 20.0F},
                                              {99.8F, 50.0F}};
  const FeatureCounts counts =
      count_features(truth, positions, {false, true, true, false, true, true, true});
  EXPECT_EQ(counts.inside, 2U);
  EXPECT_EQ(counts.inside_removed, 1U);
  EXPECT_EQ(counts.outside, 5U);
  EXPECT_EQ(counts.outside_kept, 4U);
  EXPECT_THROW(count_features(truth, positions, {true}), Error);
}

TEST(MaskScoreTally, MeansOverFramesAndSharesOverFeatures) {
  MaskScoreTally tally;
  EXPECT_FALSE(tally.mean_iou().has_value());
  EXPECT_FALSE(tally.removed_share().has_value());
  const std::vector<RegionScore> two = {{0.1, 0.9}, {0.2, 0.5}};
  const std::vector<RegionScore> one = {{0.1, 0.3}};
  tally.add(two, {.inside = 10, .inside_removed = 9, .outside = 100, .outside_kept = 80});
  tally.add(one, {.inside = 30, .inside_removed = 30, .outside = 0, .outside_kept = 0});
  tally.add({}, {.inside = 0, .inside_removed = 0, .outside = 100, .outside_kept = 100});
  EXPECT_EQ(tally.frames(), 2U);
  EXPECT_DOUBLE_EQ(*tally.mean_iou(), 0.5);
  EXPECT_DOUBLE_EQ(*tally.removed_share(), 39.0 / 40.0);
  EXPECT_DOUBLE_EQ(*tally.kept_share(), 180.0 / 200.0);
}

}  // namespace
}  // namespace dkp_slam

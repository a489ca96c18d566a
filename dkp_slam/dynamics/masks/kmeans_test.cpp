#include "dkp_slam/dynamics/masks/kmeans.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

DepthHistogram three_layers() {
  DepthHistogram histogram;
  for (int i = 0; i < 300; ++i) histogram.add(1.00F + 0.0001F * static_cast<float>(i));
  for (int i = 0; i < 200; ++i) histogram.add(2.00F + 0.0001F * static_cast<float>(i));
  for (int i = 0; i < 100; ++i) histogram.add(4.00F + 0.0001F * static_cast<float>(i));
  return histogram;
}

TEST(KMeans, FindsSeparateLayersInOrderOfDepth) {
  const auto clusters = kmeans(three_layers(), 3, 7);
  ASSERT_EQ(clusters.size(), 3U);
  EXPECT_NEAR(clusters[0].centre, 1.015F, 0.02F);
  EXPECT_NEAR(clusters[1].centre, 2.01F, 0.02F);
  EXPECT_NEAR(clusters[2].centre, 4.005F, 0.02F);
  EXPECT_EQ(clusters[0].count, 300);
  EXPECT_EQ(clusters[1].count, 200);
  EXPECT_EQ(clusters[2].count, 100);
  EXPECT_FLOAT_EQ(clusters[0].high, clusters[1].low);
  EXPECT_NEAR(clusters[1].low, 1.51F, 0.05F);
}

TEST(KMeans, GivesFewerClustersThanAskedForWhereDepthsAreFewer) {
  DepthHistogram histogram;
  for (int i = 0; i < 10; ++i) histogram.add(1.5F);
  EXPECT_EQ(kmeans(histogram, 5, 1).size(), 1U);
  EXPECT_TRUE(kmeans(DepthHistogram(), 4, 1).empty());
}

TEST(KMeans, RepeatsForTheSameSeed) {
  const auto a = kmeans(three_layers(), 6, 42), b = kmeans(three_layers(), 6, 42);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].centre, b[i].centre);
}

TEST(DepthHistogram, CountsBetween) {
  const DepthHistogram histogram = three_layers();
  EXPECT_EQ(histogram.total(), 600);
  EXPECT_EQ(histogram.count_between(0.5F, 1.5F), 300);
  EXPECT_EQ(histogram.count_between(1.5F, 5.0F), 300);
  EXPECT_NEAR(histogram.max_value(), 4.0099F, 1e-4F);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/geometry/ransac.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

namespace dkp_slam {
namespace {

struct Line {
  double slope = 0.0, offset = 0.0;
};

/// 70 points on y = 0.5 x + 2, to a hundredth, and 30 anywhere.
class LineSearch {
 public:
  explicit LineSearch(std::uint64_t seed) : random_(seed) {
    std::mt19937_64 world(7);
    std::uniform_real_distribution<double> along(0.0, 10.0), noise(-0.01, 0.01);
    for (int i = 0; i < 100; ++i) {
      const double x = along(world);
      points_.emplace_back(x, i < 70 ? 0.5 * x + 2.0 + noise(world) : along(world));
    }
  }

  std::optional<Line> sample() {
    const Eigen::Vector2d& a = points_[random_() % points_.size()];
    const Eigen::Vector2d& b = points_[random_() % points_.size()];
    if (std::abs(a.x() - b.x()) < least_apart) return std::nullopt;
    const double slope = (b.y() - a.y()) / (b.x() - a.x());
    return Line{slope, a.y() - slope * a.x()};
  }

  int score(const Line& line, int /*best*/) const {
    int inliers = 0;
    for (const Eigen::Vector2d& p : points_) {
      inliers += std::abs(line.slope * p.x() + line.offset - p.y()) < 0.03;
    }
    return inliers;
  }

  double least_apart = 0.5;

 private:
  std::mt19937_64 random_;
  std::vector<Eigen::Vector2d> points_;
};

TEST(Ransac, FindsTheLineAmongOthers) {
  LineSearch search(1);
  const auto report = ransac<Line>(search, 200, 0);
  ASSERT_TRUE(report.model.has_value());
  EXPECT_NEAR(report.model->slope, 0.5, 0.01);
  EXPECT_NEAR(report.model->offset, 2.0, 0.03);
  EXPECT_GE(report.score, 65);
  EXPECT_EQ(report.samples, 200);
  EXPECT_GT(report.degenerate, 0);
}

TEST(Ransac, TheSameSeedFindsTheSame) {
  LineSearch one(3), two(3);
  const auto a = ransac<Line>(one, 50, 0), b = ransac<Line>(two, 50, 0);
  EXPECT_EQ(a.model->slope, b.model->slope);
  EXPECT_EQ(a.score, b.score);
}

TEST(Ransac, WhatIsNoBetterThanTheStartLeavesIt) {
  LineSearch search(1);
  const auto report = ransac<Line>(search, 200, 101, std::optional(Line{9.0, 9.0}));
  EXPECT_EQ(report.model->slope, 9.0);
  EXPECT_EQ(report.score, 101);
  LineSearch again(1);
  EXPECT_FALSE(ransac<Line>(again, 200, 101).model.has_value());
}

TEST(Ransac, SamplesWithoutAModelAreCountedAndEndIt) {
  LineSearch search(1);
  search.least_apart = 100.0;
  const auto report = ransac<Line>(search, 40, 0);
  EXPECT_FALSE(report.model.has_value());
  EXPECT_EQ(report.samples, 40);
  EXPECT_EQ(report.degenerate, 40);
}

TEST(Ransac, StopsWhenTheModelSaysSo) {
  struct : LineSearch {
    using LineSearch::LineSearch;
    double samples_needed(const Line& line) const { return score(line, 0) >= 60 ? 1.0 : 1e9; }
  } search(1);
  const auto report = ransac<Line>(search, 100000, 0);
  EXPECT_LT(report.samples, 1000);
  EXPECT_GE(report.score, 60);
}

TEST(Ransac, RefinesEachBetterModelOnce) {
  struct : LineSearch {
    using LineSearch::LineSearch;
    void refine(Line& line, int& inliers) {
      ++refined;
      line = {0.5, 2.0};
      inliers = score(line, 0);
    }
    int refined = 0;
  } search(1);
  const auto report = ransac<Line>(search, 200, 0);
  EXPECT_EQ(report.model->offset, 2.0);
  EXPECT_EQ(search.refined, 1);  // nothing is better than the true line
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/evaluation/report/page_charts.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/evaluation/report/test_markup.h"

namespace dkp_slam {
namespace {

using dkp_slam::testing::charts_of;
using dkp_slam::testing::MarkupCheck;
using ::testing::HasSubstr;
using ::testing::Not;

/// A path along x, a centimetre per pose, 30 per second from second 100 on.
Trajectory line(std::size_t poses, double y = 0.0) {
  Trajectory path;
  for (std::size_t i = 0; i < poses; ++i) {
    const auto k = static_cast<double>(i);
    path.push_back(
        {100.0 + k / 30.0, Se3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.01 * k, y, 1.5))});
  }
  return path;
}

ScoredPath scored(const std::string& name, const Trajectory& truth, const Trajectory& estimate) {
  return {name, {31, 110, 190}, estimate, absolute_error(truth, estimate)};
}

nlohmann::json only_chart(const std::string& html) {
  EXPECT_EQ(MarkupCheck(html).problem(), "");
  const auto charts = charts_of(html);
  EXPECT_EQ(charts.size(), 1U);
  return charts.empty() ? nlohmann::json() : charts[0];
}

TEST(PageCharts, PathsHoldEveryPoseAlignedToTheTruth) {
  const Trajectory truth = line(60);
  // Elsewhere and later, but the same once aligned.
  Trajectory estimate = line(40, 3.0);
  const std::vector<ScoredPath> paths{scored("a", truth, estimate)};
  const auto chart = only_chart(path_chart(truth, paths));
  EXPECT_EQ(chart.at("kind"), "paths");
  ASSERT_EQ(chart.at("series").size(), 2U);
  // The truth goes on after the estimate's end, which is not compared.
  const auto& true_path = chart.at("series")[0];
  EXPECT_EQ(true_path.at("name"), "true path");
  EXPECT_EQ(true_path.at("t").size(), 40U);
  const auto& path = chart.at("series")[1];
  EXPECT_EQ(path.at("name"), "a");
  EXPECT_EQ(path.at("colour"), "#1f6ebe");
  ASSERT_EQ(path.at("x").size(), 40U);
  EXPECT_DOUBLE_EQ(path.at("t")[30], 1.0);
  EXPECT_NEAR(path.at("x")[30].get<double>(), 0.3, 1e-4);
  EXPECT_NEAR(path.at("y")[30].get<double>(), 0.0, 1e-4);
  EXPECT_NEAR(path.at("z")[30].get<double>(), 1.5, 1e-4);
}

TEST(PageCharts, ErrorsStandAtTheirTimes) {
  const Trajectory truth = line(30);
  Trajectory estimate = line(30);
  for (std::size_t i = 0; i < 30; ++i) {
    estimate[i].world_from_camera.translation.z() += i % 2 ? 0.02 : -0.02;
  }
  const std::vector<ScoredPath> paths{scored("a", truth, estimate), scored("b", truth, truth)};
  const auto chart = only_chart(error_chart(paths));
  EXPECT_EQ(chart.at("kind"), "errors");
  ASSERT_EQ(chart.at("series").size(), 2U);
  ASSERT_EQ(chart.at("series")[0].at("error").size(), 30U);
  EXPECT_NEAR(chart.at("series")[0].at("error")[15].get<double>(), 0.02, 1e-3);
  EXPECT_NEAR(chart.at("series")[0].at("t")[15].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(chart.at("series")[1].at("error")[15].get<double>(), 0.0, 1e-6);
}

TEST(PageCharts, AHistogramHoldsEveryFrame) {
  const std::vector<FrameValues> series{{"a", {1, 2, 3}, {10.0, 20.0004, 30.0}}};
  const auto chart = only_chart(histogram_chart("times", series, "time of a frame", "ms"));
  EXPECT_EQ(chart.at("unit"), "ms");
  EXPECT_EQ(chart.at("series")[0].at("values"), nlohmann::json({10.0, 20.0, 30.0}));
}

TEST(PageCharts, NamesCannotEndTheElement) {
  const std::string evil = "</script><script>alert(1)</script><!--&\xff";
  const Trajectory truth = line(30);
  const std::vector<ScoredPath> paths{scored(evil, truth, truth)};
  const std::string html =
      path_chart(truth, paths) + error_chart(paths) +
      histogram_chart(evil, std::vector<FrameValues>{{evil, {}, {1.0}}}, evil, evil);
  EXPECT_EQ(MarkupCheck(html).problem(), "");
  EXPECT_THAT(html, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(html, Not(HasSubstr("<!--")));
  for (const auto& chart : charts_of(html)) {
    EXPECT_EQ(chart.at("series").back().at("name"),
              "</script><script>alert(1)</script><!--&\xEF\xBF\xBD");
  }
}

TEST(PageCharts, NothingToDrawIsNoChart) {
  EXPECT_EQ(path_chart(line(30), {}), "");
  EXPECT_EQ(error_chart(std::span<const ScoredPath>()), "");
  const std::vector<ScoredPath> paths{scored("a", line(30), line(30))};
  EXPECT_EQ(path_chart({}, paths), "");
}

}  // namespace
}  // namespace dkp_slam

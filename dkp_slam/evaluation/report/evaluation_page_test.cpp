#include "dkp_slam/evaluation/report/evaluation_page.h"

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

/// A circle in two seconds, every other pose `error` above and below it.
Trajectory up_and_down(double error) {
  Trajectory path;
  for (int i = 0; i < 60; ++i) {
    path.push_back({10.0 + i / 30.0, {}});
    path.back().world_from_camera.translation = {std::cos(0.1 * i), std::sin(0.1 * i),
                                                 i % 2 ? error : -error};
  }
  return path;
}

TEST(EvaluationPage, HoldsFiguresPathsErrorsAndDrift) {
  const Trajectory truth = up_and_down(0.0), estimate = up_and_down(0.01);
  const std::string page =
      evaluation_page(truth, estimate, evaluate(truth, estimate), "truth.txt", "mine.txt");
  EXPECT_EQ(MarkupCheck(page).problem(), "");
  EXPECT_THAT(page, HasSubstr("mine.txt: 60 poses, of which 60 were compared with truth.txt"));
  EXPECT_THAT(page, HasSubstr("<td class=\"l\">ATE</td><td class=\"l\">m</td><td>60</td>"
                              "<td>0.0100"));
  const auto charts = charts_of(page);
  ASSERT_EQ(charts.size(), 3U);
  ASSERT_EQ(charts[0].at("series").size(), 2U);
  EXPECT_EQ(charts[0].at("series")[1].at("x").size(), 60U);
  EXPECT_EQ(charts[1].at("series")[0].at("error").size(), 60U);
  ASSERT_EQ(charts[2].at("series").size(), 2U);
  EXPECT_EQ(charts[2].at("series")[0].at("name"), "over 1 s");
  EXPECT_EQ(charts[2].at("series")[1].at("name"), "over 1 f");
  // From a pose below to one above, of 59 steps all but the one that ends in the last pose.
  ASSERT_EQ(charts[2].at("series")[1].at("error").size(), 58U);
  EXPECT_NEAR(charts[2].at("series")[1].at("error")[7].get<double>(), 0.02, 1e-4);
}

TEST(EvaluationPage, WhatCannotBeComparedIsSaidAndNamesAreText) {
  const Trajectory truth = up_and_down(0.0), estimate = up_and_down(0.01);
  EvaluationOptions options;
  options.steps = {{.delta = 100.0}};
  const std::string page = evaluation_page(truth, estimate, evaluate(truth, estimate, options),
                                           "<b>t", "<script>alert(1)</script>");
  EXPECT_EQ(MarkupCheck(page).problem(), "");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("RPE 100 s"));
  EXPECT_EQ(charts_of(page).size(), 2U);
}

}  // namespace
}  // namespace dkp_slam

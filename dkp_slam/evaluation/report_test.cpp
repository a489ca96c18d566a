#include "dkp_slam/evaluation/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using testing::HasSubstr;

/// Poses on the x axis, 10 a second; every second one is `error` metres off to the side.
Trajectory path(int count, double error) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({0.1 * i, Se3(Eigen::Quaterniond::Identity(),
                                  Eigen::Vector3d(0.1 * i, i % 2 == 0 ? error : -error, 0.0))});
  }
  return poses;
}

TEST(Report, TextHasARowForEachFigure) {
  const std::string text =
      text_report(evaluate(path(40, 0.0), path(40, 0.02)), "truth.txt", "estimate.txt");
  EXPECT_THAT(text, HasSubstr("ground truth  truth.txt: 40 poses\n"));
  EXPECT_THAT(text, HasSubstr("trajectory    estimate.txt: 40 poses, 40 compared\n"));
  EXPECT_THAT(text, HasSubstr("RMSE       mean     median       S.D.        min        max\n"));
  EXPECT_THAT(text, HasSubstr("\nATE              m      40"));
  EXPECT_THAT(text, HasSubstr("\nRPE 1 s          m      29"));
  // Neighbours are 4 cm apart to the side.
  EXPECT_THAT(text, HasSubstr("\nRPE 1 frame      m      38   0.040000   0.040000   0.040000"));
}

TEST(Report, JsonHoldsTheSameFiguresWithEveryDigit) {
  const EvaluationReport report = evaluate(path(40, 0.0), path(40, 0.02),
                                           {.association = {.max_difference = 0.03},
                                            .steps = {{.delta = 3.0, .unit = StepUnit::frames}}});
  const auto json = nlohmann::json::parse(json_report(report, "t", "e\xff"));
  EXPECT_EQ(json.at("ground_truth").at("poses"), 40);
  EXPECT_EQ(json.at("association").at("max_difference_s"), 0.03);
  EXPECT_EQ(json.at("ate").at("pairs"), 40);
  EXPECT_EQ(json.at("ate").at("translation_m").at("rmse"), report.absolute.statistics.rmse);
  ASSERT_EQ(json.at("rpe").size(), 1U);
  EXPECT_EQ(json.at("rpe")[0].at("delta"), 3.0);
  EXPECT_EQ(json.at("rpe")[0].at("unit"), "f");
  EXPECT_NEAR(json.at("rpe")[0].at("translation_m").at("rmse").get<double>(), 0.04, 1e-12);
  EXPECT_NEAR(json.at("rpe")[0].at("rotation_deg").at("max").get<double>(), 0.0, 1e-9);
}

TEST(Report, AStepThatIsTooLongIsSaidAndCostsNothingElse) {
  const EvaluationReport report = evaluate(path(6, 0.0), path(6, 0.01));
  ASSERT_EQ(report.steps.size(), 2U);
  EXPECT_FALSE(report.steps[0].error.has_value()) << "0.5 s have no pair 1 s apart";
  EXPECT_TRUE(report.steps[1].error.has_value());
  EXPECT_THAT(text_report(report, "t", "e"), HasSubstr("shorter step"));
  const auto json = nlohmann::json::parse(json_report(report, "t", "e"));
  EXPECT_THAT(json.at("rpe")[0].at("problem").get<std::string>(), HasSubstr("shorter step"));
  EXPECT_THROW(evaluate(path(6, 0.0), path(1, 0.0)), Error);
}

TEST(Report, TheOffsetGoesForTheRelativeErrorToo) {
  Trajectory late = path(40, 0.0);
  for (StampedPose& pose : late) pose.timestamp += 500.0;
  const EvaluationReport report =
      evaluate(path(40, 0.0), late, {.association = {.offset = -500.0}});
  ASSERT_TRUE(report.steps[0].error.has_value());
  EXPECT_LT(report.steps[0].error->translation.max, 1e-9);
}

}  // namespace
}  // namespace dkp_slam

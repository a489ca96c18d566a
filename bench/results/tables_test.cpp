#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/results/figures.h"
#include "bench/results/markdown.h"
#include "bench/results/targets.h"
#include "dkp_slam/error.h"

namespace dkp_slam::bench {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Optional;

RunFigures run_with_error(const std::string& sequence, const std::string& mode, std::uint64_t seed,
                          double ate) {
  RunFigures run;
  run.key = {sequence, mode, seed};
  run.frames = 100;
  run.ate_rmse = ate;
  return run;
}

Target ate_target(double must, double aim, bool all_localised = false) {
  return {"ATE",
          "room",
          "dkp+",
          Quantity::ate,
          {must, Bound::Side::at_most},
          Bound{aim, Bound::Side::at_most},
          all_localised};
}

TEST(Figures, MedianIsOfTheGoodRunsOfOneSequenceAndMode) {
  Results results;
  results.runs = {run_with_error("room", "dkp+", 1, 0.03), run_with_error("room", "off", 1, 9.0),
                  run_with_error("hall", "dkp+", 1, 8.0),  run_with_error("room", "dkp+", 2, 0.01),
                  run_with_error("room", "dkp+", 3, 0.02), run_with_error("room", "dkp+", 4, 7.0)};
  results.runs.back().problem = "exit code 1";
  const auto found = values(results, "room", "dkp+", Quantity::ate);
  EXPECT_THAT(found, ElementsAre(0.03, 0.01, 0.02));
  EXPECT_THAT(median_of(found), Optional(0.02));
  EXPECT_EQ(median_of(values(results, "room", "dk", Quantity::ate)), std::nullopt);
}

TEST(Figures, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  EXPECT_THAT(median_of({4.0, 1.0, 3.0, 100.0}), Optional(3.5));
}

TEST(Figures, ProcessorAndWallTimeArePerFrame) {
  Results results;
  results.runs = {run_with_error("room", "off", 1, 0.0)};
  results.runs[0].processor_s = 5.0;
  results.runs[0].wall_s = 3.0;
  EXPECT_THAT(values(results, "room", "off", Quantity::processor_ms), ElementsAre(DoubleEq(50.0)));
  EXPECT_THAT(values(results, "room", "off", Quantity::wall_ms), ElementsAre(DoubleEq(30.0)));
}

TEST(Figures, MissingDriftIsNoValue) {
  Results results;
  results.runs = {run_with_error("room", "off", 1, 0.0)};
  EXPECT_THAT(values(results, "room", "off", Quantity::rpe_second), IsEmpty());
  results.runs[0].rpe_second = 0.25;
  EXPECT_THAT(values(results, "room", "off", Quantity::rpe_second), ElementsAre(0.25));
}

TEST(Timings, MediansByStageAndOfTheSumWithoutDetection) {
  const std::string csv =
      "index,localised,decode_ms,features_ms,detection_ms,clustering_ms,removal_ms,tracking_ms,"
      "frame_ms\n"
      "0,1,9,1,100,1,1,7,20\n"
      "1,1,8,5,200,1,1,1,30\n"
      "2,1,7,1,300,9,1,1,40\n";
  RunFigures run;
  set_times(run, read_timings(csv));
  EXPECT_EQ(run.stage_ms.at("decode"), 8.0);
  EXPECT_EQ(run.stage_ms.at("detection"), 200.0);
  EXPECT_EQ(run.stage_ms.at("frame"), 30.0);
  EXPECT_EQ(run.stage_ms.count("index"), 0U);
  // Sums 10, 8 and 12; the medians of the stages would add up to 1 + 1 + 1 + 1.
  EXPECT_EQ(run.without_detection_ms, 10.0);
}

TEST(Timings, DamagedTablesAreRefused) {
  EXPECT_TRUE(
      std::isinf(read_timings("index,position_sigma_m\n1,inf\n").at("position_sigma_m")[0]));
  EXPECT_THROW(read_timings("a_ms\nnan\n"), Error);
  EXPECT_THROW(read_timings(""), Error);
  EXPECT_THROW(read_timings("a_ms,b_ms\n"), Error);
  EXPECT_THROW(read_timings("a_ms,a_ms\n1,2\n"), Error);
  EXPECT_THROW(read_timings("a_ms,b_ms\n1.0\n"), Error);
  EXPECT_THROW(read_timings("a_ms,b_ms\n1.0,2x\n"), Error);
  RunFigures run;
  EXPECT_THROW(set_times(run, read_timings("frame_ms\n1.0\n")), Error);
}

TEST(Judge, TheLimitItselfIsKept) {
  const Bound most{0.011, Bound::Side::at_most}, least{0.8, Bound::Side::at_least};
  EXPECT_EQ(judge(0.011, most), Verdict::pass);
  EXPECT_EQ(judge(0.01101, most), Verdict::fail);
  EXPECT_EQ(judge(0.8, least), Verdict::pass);
  EXPECT_EQ(judge(0.7999, least), Verdict::fail);
  EXPECT_EQ(judge(std::nullopt, least), Verdict::not_measured);
}

TEST(Stand, MustAndAimAreJudgedByTheMedian) {
  Results results;
  results.runs = {run_with_error("room", "dkp+", 1, 0.010),
                  run_with_error("room", "dkp+", 2, 0.012),
                  run_with_error("room", "dkp+", 3, 0.500)};
  const Standing standing = stand(ate_target(0.015, 0.011), results);
  EXPECT_THAT(standing.value, Optional(0.012));
  EXPECT_EQ(standing.must, Verdict::pass);
  EXPECT_EQ(standing.aim, Verdict::fail);
  EXPECT_THAT(standing.runs, ElementsAre(0.010, 0.012, 0.500));
}

TEST(Stand, OneLostFrameInOneRunFailsWhereAllMustBeLocalised) {
  Results results;
  results.runs = {run_with_error("room", "dkp+", 1, 0.010),
                  run_with_error("room", "dkp+", 2, 0.010)};
  results.runs[1].lost_frames = 1;
  EXPECT_EQ(stand(ate_target(0.015, 0.011), results).must, Verdict::pass);
  const Standing strict = stand(ate_target(0.015, 0.011, true), results);
  EXPECT_EQ(strict.must, Verdict::fail);
  EXPECT_EQ(strict.lost_frames, 1U);
}

TEST(Stand, AFailedRunFailsAndNoRunIsNotMeasured) {
  Results results;
  EXPECT_EQ(stand(ate_target(0.015, 0.011), results).must, Verdict::not_measured);
  results.runs = {run_with_error("room", "dkp+", 1, 0.010), run_with_error("room", "dkp+", 2, 0.0)};
  results.runs[1].problem = "exit code 1";
  const Standing standing = stand(ate_target(0.015, 0.011), results);
  EXPECT_EQ(standing.must, Verdict::fail);
  EXPECT_EQ(standing.failed_runs, 1U);
  EXPECT_THAT(standing.value, Optional(0.010));
}

TEST(Stand, WithoutASequenceTheWorstCounts) {
  Results results;
  results.runs = {run_with_error("a", "off", 1, 0.0), run_with_error("b", "off", 1, 0.0),
                  run_with_error("c", "off", 1, 0.0), run_with_error("d", "dkp+", 1, 0.0)};
  results.runs[0].stage_ms["frame"] = 20.0;
  results.runs[1].stage_ms["frame"] = 40.0;
  results.runs[2].stage_ms["frame"] = 30.0;
  results.runs[3].stage_ms["frame"] = 90.0;
  Target target = ate_target(33.0, 20.0);
  target.sequence = "";
  target.mode = "off";
  target.quantity = Quantity::frame_ms;
  const Standing standing = stand(target, results);
  EXPECT_EQ(standing.sequence, "b");
  EXPECT_THAT(standing.value, Optional(40.0));
  EXPECT_EQ(standing.must, Verdict::fail);
}

TEST(Stand, MasksHaveTheirOwnFigures) {
  Results results;
  for (const double iou : {0.90, 0.70, 0.85}) {
    results.masks.push_back({{"room", "dkp+", 1}, 10, iou, std::nullopt, 0.5});
  }
  Target target = ate_target(0, 0);
  target.quantity = Quantity::mask_iou;
  target.must = {0.80, Bound::Side::at_least};
  target.aim = Bound{0.88, Bound::Side::at_least};
  const Standing standing = stand(target, results);
  EXPECT_THAT(standing.value, Optional(0.85));
  EXPECT_EQ(standing.must, Verdict::pass);
  EXPECT_EQ(standing.aim, Verdict::fail);
  EXPECT_THAT(values(results, "room", "dkp+", Quantity::features_removed), IsEmpty());
}

TEST(Markdown, TableIsPaddedAndItsCellsStayCells) {
  MarkdownTable table({"name", "value"});
  EXPECT_TRUE(table.empty());
  table.add({"a|b", "1"});
  table.add({"longer name"});
  EXPECT_FALSE(table.empty());
  EXPECT_EQ(table.text(),
            "| name        | value |\n"
            "|-------------|------:|\n"
            "| a\\|b        |     1 |\n"
            "| longer name |       |\n");
}

TEST(Markdown, NumbersAndShares) {
  EXPECT_EQ(number(0.01046, 4), "0.0105");
  EXPECT_EQ(number(std::nullopt, 4), "-");
  EXPECT_EQ(percent(0.9834), "98.3 %");
  EXPECT_EQ(percent(std::nullopt), "-");
}

}  // namespace
}  // namespace dkp_slam::bench

#include "bench/results/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam::bench {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

RunFigures run_of(const std::string& sequence, const std::string& mode, std::uint64_t seed,
                  double ate) {
  RunFigures run;
  run.key = {sequence, mode, seed};
  run.frames = 788;
  run.ate_rmse = ate;
  run.ate_deviation = ate / 2.0;
  run.stage_ms = {{"frame", 25.0}, {"detection", 15.5}};
  run.without_detection_ms = 12.5;
  run.peak_memory_mb = 200.0;
  return run;
}

Results three_runs() {
  Results results;
  for (const double ate : {0.0100, 0.0140, 0.0120}) {
    results.runs.push_back(run_of("composite_xyz_walking", "dkp+", results.runs.size() + 1, ate));
  }
  return results;
}

ReportHeader header_of(std::vector<std::uint64_t> seeds) {
  ReportHeader header;
  header.date = "2001-02-03";
  header.sequences = {"composite_xyz_walking"};
  header.modes = {"off", "dkp+"};
  header.seeds = std::move(seeds);
  return header;
}

/// The first line that holds all of these.
std::string line_with(const std::string& text, const std::vector<std::string>& words) {
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = text.find('\n', start);
    const std::string line = text.substr(start, end - start);
    bool all = true;
    for (const std::string& word : words) all = all && line.find(word) != std::string::npos;
    if (all) return line;
    start = end + 1;
  }
  return "";
}

TEST(Report, GoalSaysMedianRunsAndVerdicts) {
  const std::string line = line_with(targets_table(three_runs()),
                                     {"ATE, all frames localised", "composite_xyz_walking"});
  EXPECT_THAT(line, HasSubstr("<= 0.0150"));
  EXPECT_THAT(line, HasSubstr("<= 0.0105"));
  EXPECT_THAT(line, ContainsRegex("0\\.01200 \\| +pass \\| +\\*\\*fail\\*\\* \\|"));
  EXPECT_THAT(line, HasSubstr("0.01000, 0.01400, 0.01200"));
}

TEST(Report, GoalSaysHowManyFramesWereLost) {
  Results results = three_runs();
  results.runs[1].lost_frames = 4;
  const std::string line =
      line_with(targets_table(results), {"all frames", "composite_xyz_walking"});
  EXPECT_THAT(line, HasSubstr("up to 4 frames lost"));
  EXPECT_THAT(line, Not(HasSubstr("pass")));
}

TEST(Report, GoalWithoutRunsIsOpen) {
  const std::string line = line_with(targets_table({}), {"peak memory", "dkp+"});
  EXPECT_THAT(line, HasSubstr("<= 500 MB"));
  EXPECT_THAT(line, Not(HasSubstr("pass")));
  EXPECT_THAT(line, Not(HasSubstr("fail")));
}

TEST(Report, AblationHasAModePerRow) {
  Results results = three_runs();
  for (std::size_t i = 0; i < 3; ++i) results.runs[i].lost_frames = 3 + i;
  const std::string table = ablation_table({"composite_xyz_walking"}, {"off", "dkp+"}, results);
  EXPECT_EQ(table,
            "| mode | composite_xyz_walking RMSE |   S.D. | lost |\n"
            "|------|---------------------------:|-------:|-----:|\n"
            "| off  |                          - |      - |    - |\n"
            "| dkp+ |                     0.0120 | 0.0060 |    4 |\n");
}

TEST(Report, PageHoldsEverySectionAndWarnsOfFewRunsAndLoad) {
  Results results = three_runs();
  const std::string good = report(header_of({1, 2, 3}), results);
  for (const char* section : {"# Results", "## Goals", "## Ablation", "## Drift", "## Times",
                              "## Beside other systems", "## Every run"}) {
    EXPECT_THAT(good, HasSubstr(section));
  }
  EXPECT_THAT(good, HasSubstr("2001-02-03"));
  EXPECT_THAT(good, Not(HasSubstr("Fewer than 3 runs")));
  EXPECT_THAT(good, Not(HasSubstr("Machine under load")));

  results.runs[2].others_share = 0.40;
  ReportHeader trial = header_of({1});
  trial.complete = false;
  const std::string bad = report(trial, results);
  EXPECT_THAT(bad, HasSubstr("Fewer than 3 runs"));
  EXPECT_THAT(bad, HasSubstr("up to 40.0 %"));
  EXPECT_THAT(bad, HasSubstr("Interrupted"));
}

TEST(Report, FailedRunIsListedWithItsProblem) {
  Results results = three_runs();
  results.runs[0].problem = "exit code 1: no such camera";
  const std::string page = report(header_of({1, 2, 3}), results);
  EXPECT_THAT(page, HasSubstr("exit code 1: no such camera"));
  EXPECT_THAT(line_with(page, {"ATE, all frames localised", "composite_xyz_walking"}),
              HasSubstr("(1 failed)"));
}

}  // namespace
}  // namespace dkp_slam::bench

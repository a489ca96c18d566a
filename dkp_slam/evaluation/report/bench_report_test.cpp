#include "dkp_slam/evaluation/report/bench_report.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/evaluation/report/published.h"
#include "dkp_slam/evaluation/report/record_set.h"
#include "dkp_slam/evaluation/report/test_markup.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::charts_of;
using dkp_slam::testing::MarkupCheck;
using dkp_slam::testing::occurrences;
using ::testing::HasSubstr;
using ::testing::Not;

RunRecord record(const std::string& sequence, const std::string& mode, std::uint64_t seed,
                 double ate) {
  RunRecord r;
  r.sequence = sequence;
  r.mode = mode;
  r.detector = mode == "off" ? "none" : "motion";
  r.seed = seed;
  r.frames = 40;
  r.lost = 2;
  r.keyframes = 17;
  r.landmarks = 1234;
  r.loops_closed = 4;
  r.maps_joined = 5;
  r.maps = 6;
  r.ate_m = ate;
  r.ate_deviation_m = ate / 2.0;
  r.rpe_s_m = 0.0321;
  r.rpe_s_deg = 0.765;
  r.rpe_frame_m = 0.0043;
  r.rpe_frame_deg = 0.234;
  r.features = 1000;
  r.removed = 123;
  r.stage_ms = {{"detection", 11.11}, {"clustering", 2.22}, {"removal", 3.33}, {"tracking", 4.44},
                {"features", 5.55},   {"decode", 6.66},     {"frame", 17.77}};
  r.total_s = 2.5;
  r.processor_s = 3.5;
  r.peak_memory_mb = 222.0;
  r.version = "9.8.7";
  r.program = "feedbeef";
  r.machine = "Test Machine 3000";
  r.date = "2026-02-03T04:05:06Z";
  return r;
}

/// Three seeds of two modes on a recording, a twin and another sequence.
std::vector<RunRecord> sample_records() {
  std::vector<RunRecord> records;
  for (const char* sequence : {"fr3_walking_xyz", "walking_rpy", "kitchen"}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      records.push_back(record(sequence, "off", seed, 0.4 + 0.01 * static_cast<double>(seed)));
      records.push_back(
          record(sequence, "dkp+", seed, 0.0112 + 0.0001 * static_cast<double>(seed)));
    }
  }
  return records;
}

/// The row of the first table after `heading` that holds `text`.
std::string row_after(const std::string& page, const std::string& heading,
                      const std::string& text) {
  const std::size_t at = page.find(text, page.find(heading));
  const std::size_t start = page.rfind("<tr", at);
  return page.substr(start, page.find("</tr>", at) - start);
}

class BenchReport : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("bench_report_") + info->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string page_of(const std::vector<RunRecord>& records,
                      const std::vector<std::string>& warnings = {}) const {
    std::string page = bench_report(records, {folder_, "2026-03-04", warnings});
    EXPECT_EQ(MarkupCheck(page).problem(), "");
    return page;
  }
  /// Files of a run as bench leaves them: a circle, and every other pose a little beside it.
  void write_run(const RunRecord& r, double error, int poses) const {
    Trajectory truth, estimate;
    std::string timings = "index,frame_ms\n";
    for (int i = 0; i < poses; ++i) {
      StampedPose pose{100.0 + i / 30.0, {}};
      pose.world_from_camera.translation = {std::cos(0.1 * i), std::sin(0.1 * i), 1.0};
      truth.push_back(pose);
      pose.world_from_camera.translation.z() += i % 2 ? error : -error;
      estimate.push_back(pose);
      timings += fmt::format("{},{}\n", i, 10 + i % 5);
    }
    const fs::path run = folder_ / run_name(r);
    fs::create_directories(run);
    write_trajectory(folder_ / r.sequence / "groundtruth.txt", truth);
    write_trajectory(run / "trajectory.txt", estimate);
    std::ofstream(run / "timings.csv") << timings;
  }

  fs::path folder_;
};

TEST_F(BenchReport, MediansStandInTheTableWithTheirSpread) {
  const std::string page = page_of(sample_records());
  EXPECT_THAT(page, HasSubstr("<th>ATE [m]</th><th>RPE 1 s [m]</th><th>[deg]</th>"
                              "<th>RPE frame [m]</th><th>[deg]</th><th>lost</th>"
                              "<th>removed [%]</th><th>frame [ms]</th>"));
  EXPECT_THAT(row_after(page, "id=\"overview\"", "dkp+, motion"),
              HasSubstr("<td>3</td><td>0.0114<small>0.0113–0.0115</small></td><td>0.0321</td>"
                        "<td>0.765</td><td>0.0043</td><td>0.234</td><td>2</td><td>12.3</td>"
                        "<td>17.8</td>"));
}

TEST_F(BenchReport, RecordingsAndTwinsStandApartBesidePublishedFigures) {
  const std::string page = page_of(sample_records());
  for (const char* table : {"Table 2", "Table 4"}) {
    const std::size_t section = page.find(std::string("<h3>") + table);
    ASSERT_NE(section, std::string::npos);
    const std::string text = page.substr(section, page.find("</table>", section) - section);
    // The paper's figure of its own system, which both tables hold.
    EXPECT_THAT(text, HasSubstr("<td class=\"l\">DKP-SLAM</td><td>0.0243</td><td>0.0345</td>"));
    // W/xyz is the fourth sequence, W/rpy the second.
    EXPECT_THAT(text, HasSubstr("dkp-slam dkp+, motion<small>on the recordings, fr3</small></td>"
                                "<td></td><td></td><td></td><td>0.0114<small>"));
    EXPECT_THAT(text, HasSubstr("dkp-slam dkp+, motion<small>on synthetic twins</small></td>"
                                "<td></td><td>0.0114<small>"));
    EXPECT_THAT(text, HasSubstr("dkp-slam off<small>on synthetic twins</small></td>"
                                "<td></td><td>0.4200<small>"));
  }
  const std::size_t rpe = page.find("<h3>Table 5");
  EXPECT_THAT(page.substr(rpe), HasSubstr("dkp-slam dkp+, motion, over 1 frame<small>"));
  EXPECT_THAT(page.substr(rpe), HasSubstr("<td>0.1503</td>"));  // DS-SLAM on W/rpy
}

TEST_F(BenchReport, AblationAndTimesStandBesideThePapers) {
  std::vector<RunRecord> records = sample_records();
  records.push_back(record("fr3_walking_xyz", "dk", 1, 0.0333));
  const std::string page = page_of(records);
  const std::string row = row_after(page, "id=\"ablation\"", "dk, motion");
  EXPECT_THAT(row, HasSubstr("<td>0.0333</td><td>0.0167</td><td>2</td><td>0.0228</td>"));
  const std::string times = row_after(page, "<h3>Table 7", "dkp-slam dkp+, motion");
  for (const char* figure : {"11.11", "2.22", "3.33", "4.44", "5.55", "6.66", "17.77"}) {
    EXPECT_THAT(times, HasSubstr(figure));
  }
  EXPECT_THAT(page, Not(HasSubstr("not to be quoted")));
  records[0].others_share = 0.25;
  EXPECT_THAT(page_of(records), HasSubstr("Other programs took up to 25 %"));
  records[1].jobs = 3;
  EXPECT_THAT(page_of(records), HasSubstr("Up to 3 runs shared the machine"));
  const std::size_t systems = page.find("<h3>Table 8");
  EXPECT_THAT(page.substr(systems), HasSubstr("696.09"));
  EXPECT_THAT(row_after(page, "<h3>Table 8", "dkp-slam dkp+, motion"),
              HasSubstr("Test Machine 3000"));
}

TEST_F(BenchReport, EveryRunIsListedAndFailedOnesWithTheirReason) {
  std::vector<RunRecord> records = sample_records();
  RunRecord failed = record("kitchen", "dkp", 1, 0.0);
  failed.exit_code = 1;
  failed.problem = "exit code 1: <camera> broken";
  records.push_back(failed);
  const std::string page = page_of(records);
  const std::size_t runs = page.find("id=\"runs\"");
  EXPECT_EQ(occurrences(page.substr(runs), "<tr>"), 1 + records.size());
  EXPECT_THAT(page.substr(runs), HasSubstr("exit code 1: &lt;camera&gt; broken"));
  EXPECT_THAT(
      page.substr(runs),
      HasSubstr("<th>seed</th><th>frames</th><th>lost</th><th>ATE [m]</th><th>S.D. [m]</th>"
                "<th>RPE 1 s [m]</th><th>frame [ms]</th><th>keyframes</th><th>landmarks</th>"
                "<th>loops</th><th>joins</th><th>maps</th><th>total [s]</th>"
                "<th>processor [s]</th><th>memory [MB]</th><th>others [%]</th>"
                "<th>date</th><th>problem</th>"));
  EXPECT_THAT(page.substr(runs),
              HasSubstr("<td>3</td><td>40</td><td>2</td><td>0.01150</td><td>0.00575</td>"
                        "<td>0.03210</td><td>17.8</td><td>17</td><td>1234</td><td>4</td><td>5</td>"
                        "<td>6</td><td>2.5</td><td>3.5</td><td>222</td>"
                        "<td>0</td><td>2026-02-03T04:05:06Z</td><td></td>"));
  EXPECT_THAT(page, HasSubstr("1 of the runs failed"));
  // It counts in no figure.
  EXPECT_THAT(page.substr(0, runs), Not(HasSubstr("dkp, motion")));
}

TEST_F(BenchReport, PathsHaveAPointForEveryPoseOfTheMedianRun) {
  std::vector<RunRecord> records;
  for (const std::uint64_t seed : {1, 2, 3}) {
    records.push_back(record("walking_xyz", "dkp+", seed, 0.02 * static_cast<double>(seed)));
    write_run(records.back(), 0.01 * static_cast<double>(seed), 30 + static_cast<int>(seed));
  }
  const auto charts = charts_of(page_of(records));
  ASSERT_EQ(charts.size(), 3U);
  EXPECT_EQ(charts[0].at("kind"), "paths");
  const auto& estimate = charts[0].at("series").at(1);
  EXPECT_EQ(estimate.at("name"), "dkp+, motion");
  EXPECT_EQ(estimate.at("colour"), "#1f6ebe");
  EXPECT_EQ(estimate.at("x").size(), 32U);  // seed 2 is the median
  EXPECT_EQ(charts[1].at("series").at(0).at("error").size(), 32U);
  EXPECT_EQ(charts[2].at("series").at(0).at("values").size(), 32U);
}

TEST_F(BenchReport, ASequenceNamedLikeATagIsText) {
  std::vector<RunRecord> records{record("<script>alert(1)", "off", 1, 0.02)};
  write_run(records[0], 0.01, 20);
  const std::string page = page_of(records);
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("<h3>&lt;script&gt;alert(1)</h3>"));
  EXPECT_EQ(charts_of(page).size(), 3U);
}

TEST_F(BenchReport, WhatIsMissingIsNotDrawnAndWarningsAreShown) {
  const std::string page = page_of(sample_records(), {"Interrupted & more."});
  EXPECT_EQ(charts_of(page).size(), 0U);
  EXPECT_THAT(page, HasSubstr("Interrupted &amp; more."));
  EXPECT_THAT(page, Not(HasSubstr("fewer than 3 runs")));
  EXPECT_THAT(page_of({record("kitchen", "off", 1, 0.3)}), HasSubstr("fewer than 3 runs"));
  EXPECT_THAT(page_of({record("kitchen", "off", 1, 0.3)}), HasSubstr("None of the sequences"));
  EXPECT_THAT(page_of({}), HasSubstr("There is no result yet"));
}

TEST_F(BenchReport, DetectorsStandSideBySideInColoursOfTheirOwn) {
  std::vector<RunRecord> records{record("a", "dkp+", 1, 0.01), record("a", "dkp+", 1, 0.02)};
  records[1].detector = "yolox";
  records[1].model = "nano.onnx";
  const RecordSet set(latest_records(records));
  ASSERT_EQ(set.configs().size(), 2U);
  EXPECT_EQ(set.best_configs().size(), 2U);
  EXPECT_EQ(set.label(set.configs()[1]), "dkp+, yolox");
  EXPECT_NE(set.colour(set.configs()[0]).blue, set.colour(set.configs()[1]).blue);
}

TEST(MedianRun, OfAnEvenNumberItIsTheBetterOfTheMiddle) {
  const RunRecord a = record("s", "off", 1, 0.4), b = record("s", "off", 2, 0.1),
                  c = record("s", "off", 3, 0.3), d = record("s", "off", 4, 0.2);
  EXPECT_EQ(median_run({&a, &b, &c, &d}), &d);
  EXPECT_EQ(median_run({&a, &b, &c}), &c);
  EXPECT_EQ(median_run({}), nullptr);
}

TEST(Published, TablesHaveTheColumnsOfThePapersSequences) {
  for (const PublishedTable* table : {&published_ate_by_base(), &published_rpe_by_base(),
                                      &published_ate_of_others(), &published_rpe_of_others()}) {
    ASSERT_EQ(table->header.size(), 1 + paper_sequences().size());
    for (std::size_t i = 0; i < paper_sequences().size(); ++i) {
      EXPECT_EQ(table->header[i + 1], paper_sequences()[i]);
    }
    for (const auto& row : table->rows) EXPECT_EQ(row.size(), table->header.size()) << row[0];
    EXPECT_THAT(table->source, HasSubstr("paper"));
  }
  for (const auto& row : published_ablation().rows) EXPECT_EQ(row.size(), 13U);
}

}  // namespace
}  // namespace dkp_slam

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/bench/plan.h"
#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/report/run_record.h"
#include "dkp_slam/evaluation/report/test_markup.h"
#include "dkp_slam/export/images/image_file.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::MarkupCheck;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;

/// Runs the program itself, as a user does, on small exact sequences.
class BenchCommand : public testing::CommandTest {
 protected:
  static constexpr int frame_count = 8;
  void SetUp() override {
    CommandTest::SetUp();
    const WallSequence made(wall(), frame_count);
  }

  fs::path wall() const { return folder_ / "wall"; }
  fs::path out(const std::string& name = "out") const { return folder_ / name; }

  int bench(const std::vector<std::string>& arguments) { return call({"bench"}, arguments); }
  std::vector<std::string> small(const std::string& name, int repeat = 2) const {
    return {
        wall(),  "--modes", "off,dkp+", "--detector", "none", "--repeat", std::to_string(repeat),
        "--out", out(name)};
  }
  std::vector<RunRecord> records(const std::string& name = "out") const {
    return read_records(out(name) / "results.jsonl");
  }
  /// What must not depend on when and where a run was made.
  std::set<std::string> figures(const std::string& name) const {
    std::set<std::string> set;
    for (const RunRecord& r : records(name)) {
      set.insert(fmt::format("{} {} {} {} {} {}", run_name(r), r.options, r.ate_m, r.frames, r.lost,
                             r.removed));
    }
    return set;
  }
  /// Refused in one line, nothing written.
  void expect_refused(int code, const std::string& why, const std::vector<std::string>& arguments) {
    EXPECT_EQ(bench(arguments), code) << why << stderr_;
    EXPECT_THAT(stderr_, HasSubstr(why));
    EXPECT_EQ(stdout_, "");
    EXPECT_FALSE(fs::exists(out()));
    if (code == 1) {
      EXPECT_EQ(std::count(stderr_.begin(), stderr_.end(), '\n'), 1) << stderr_;
    }
  }
};

TEST_F(BenchCommand, EachRunIsALineWithItsFiguresAndTheReportShowsThem) {
  ASSERT_EQ(bench(small("out")), 0) << stderr_;
  const std::vector<RunRecord> lines = latest_records(records());
  ASSERT_EQ(lines.size(), 4U);
  for (const RunRecord& r : lines) {
    EXPECT_EQ(r.sequence, "wall");
    EXPECT_EQ(r.problem, "");
    EXPECT_EQ(r.frames, frame_count);
    EXPECT_EQ(r.lost, 0U);
    const auto error =
        absolute_error(read_trajectory(wall() / "groundtruth.txt"),
                       read_trajectory(out() / "runs" / run_name(r) / "trajectory.txt"));
    EXPECT_EQ(r.ate_m, error.statistics.rmse);
    EXPECT_LT(r.ate_m, 0.002);
    EXPECT_FALSE(r.rpe_s_m.has_value());  // shorter than a second
    EXPECT_TRUE(r.rpe_frame_m.has_value());
    EXPECT_GT(r.stage_ms.at("tracking"), 0.0);
    EXPECT_GT(r.total_s, 0.0);
    EXPECT_GT(r.peak_memory_mb, 10.0);
    EXPECT_EQ(r.date.size(), std::string("2026-01-01T00:00:00Z").size());
  }
  EXPECT_EQ(lines[0].mode, "off");
  EXPECT_EQ(lines[1].seed, 2U);
  const std::string page = content(out() / "report.html");
  MarkupCheck check(page);
  EXPECT_EQ(check.problem(), "");
  EXPECT_EQ(dkp_slam::testing::charts_of(page).size(), 3U);
  EXPECT_THAT(page, HasSubstr(fmt::format("<td>{:.5f}</td>", lines[0].ate_m)));
  EXPECT_THAT(stdout_, HasSubstr((out() / "report.html").string()));
}

TEST_F(BenchCommand, MasksAreAModeOfSequencesThatHaveThem) {
  cv::Mat mask = cv::Mat::zeros(480, 640, CV_8UC1);
  mask.colRange(0, 320) = 255;
  fs::create_directory(wall() / "mask");
  for (int i = 0; i < frame_count; ++i) {
    write_image(wall() / "mask" / (WallSequence::stamp(i) + ".png"), mask);
  }
  ASSERT_EQ(bench({wall(), "--modes", "masks", "--repeat", "1", "--set", "refill.below=0", "--out",
                   out()}),
            0)
      << stderr_;
  const std::vector<RunRecord> lines = records();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(run_name(lines[0]), "wall/masks-none/seed1");
  EXPECT_EQ(lines[0].lost, 0U);
  EXPECT_NEAR(static_cast<double>(lines[0].removed) / static_cast<double>(lines[0].features), 0.5,
              0.1);
}

TEST_F(BenchCommand, WhatIsKnownIsNotRunAgain) {
  ASSERT_EQ(bench(small("out", 1)), 0) << stderr_;
  const std::string before = content(out() / "results.jsonl");
  ASSERT_EQ(bench(small("out", 1)), 0) << stderr_;
  EXPECT_EQ(content(out() / "results.jsonl"), before);
  EXPECT_THAT(stdout_, HasSubstr("2 runs asked for, 2 known from before"));
  // One seed more: only its runs are new.
  ASSERT_EQ(bench(small("out", 2)), 0) << stderr_;
  EXPECT_TRUE(content(out() / "results.jsonl").starts_with(before));
  EXPECT_EQ(records().size(), 4U);
  // Another camera is another run.
  std::ofstream(wall() / "camera.yaml", std::ios::app) << "# changed\n";
  ASSERT_EQ(bench(small("out", 1)), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("2 runs asked for, 0 known from before"));
  EXPECT_EQ(records().size(), 6U);
  EXPECT_EQ(latest_records(records()).size(), 4U);
}

TEST_F(BenchCommand, ShardsMergedAreTheWholeBench) {
  ASSERT_EQ(bench(small("whole")), 0) << stderr_;
  for (const std::string part : {"1", "2", "3"}) {
    std::vector<std::string> arguments = small("part" + part);
    arguments.insert(arguments.end(), {"--shard", part + "/3"});
    ASSERT_EQ(bench(arguments), 0) << stderr_;
  }
  const std::vector<std::string> merge{"merge",      out("part1"), out("part2"),
                                       out("part3"), "--out",      out("all")};
  ASSERT_EQ(bench(merge), 0) << stderr_;
  EXPECT_EQ(figures("whole").size(), 4U);
  EXPECT_EQ(figures("all"), figures("whole"));
  const std::string page = content(out("all") / "report.html");
  MarkupCheck check(page);
  EXPECT_EQ(check.problem(), "");
  EXPECT_EQ(dkp_slam::testing::charts_of(page).size(), 3U);  // the paths came along
  // Once more changes nothing.
  const std::string before = content(out("all") / "results.jsonl");
  ASSERT_EQ(bench(merge), 0) << stderr_;
  EXPECT_EQ(content(out("all") / "results.jsonl"), before);
}

TEST_F(BenchCommand, ResultsOfDifferentProgramsAreNotMergedUnlessTold) {
  RunRecord record;
  record.sequence = "wall";
  record.mode = "off";
  record.detector = "none";
  fs::create_directories(out("a"));
  fs::create_directories(out("b"));
  record.program = "aaaa";
  append_record(out("a") / "results.jsonl", record);
  record.seed = 2;
  record.program = "bbbb";
  append_record(out("b") / "results.jsonl", record);
  EXPECT_EQ(bench({"merge", out("a"), out("b"), "--out", out("all")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("2 different programs (aaaa, bbbb)"));
  EXPECT_FALSE(fs::exists(out("all")));
  ASSERT_EQ(bench({"merge", out("a"), out("b"), "--out", out("all"), "--mixed"}), 0) << stderr_;
  EXPECT_EQ(records("all").size(), 2U);
  EXPECT_THAT(content(out("all") / "report.html"), HasSubstr("Results of 2 different programs."));
  EXPECT_EQ(bench({"merge", out("nothing"), "--out", out("all")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("holds no results.jsonl"));
}

TEST_F(BenchCommand, CtrlCKeepsWhatThereIsAndTheSameCommandGoesOn) {
  std::vector<std::string> arguments = small("out", 20);
  arguments.insert(arguments.begin(), "bench");
  arguments.insert(arguments.end(), {"--jobs", "2"});
  const Program program = start(arguments);
  // Until the first result is there, however slow a sanitizer makes it.
  for (int i = 0; i < 24000 && records().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  program.interrupt();
  EXPECT_EQ(program.wait(), 130) << program.err();
  EXPECT_THAT(program.err(), HasSubstr("interrupted; the same command goes on"));
  const std::string before = content(out() / "results.jsonl");
  const std::size_t known = records().size();
  EXPECT_GE(known, 1U);
  ASSERT_LT(known, 40U);
  const std::string page = content(out() / "report.html");
  EXPECT_EQ(MarkupCheck(page).problem(), "");
  EXPECT_THAT(page, HasSubstr("Interrupted"));
  // A part of what was asked for, so that this test does not take long.
  const int seeds = static_cast<int>(known) / 2 + 1;
  ASSERT_EQ(bench(small("out", seeds)), 0) << stderr_;
  EXPECT_TRUE(content(out() / "results.jsonl").starts_with(before));
  std::map<std::string, int> times;
  for (const RunRecord& r : records()) ++times[run_name(r)];
  for (const auto& [name, count] : times) EXPECT_EQ(count, 1) << name;
}

TEST_F(BenchCommand, ARunThatFailsIsListedWithItsReasonAndTheBenchFails) {
  std::ofstream(wall() / "camera.yaml") << "nonsense: 1\n";
  EXPECT_EQ(bench(small("out", 1)), 1);
  EXPECT_THAT(stderr_, HasSubstr("2 runs failed"));
  ASSERT_EQ(records().size(), 2U);
  EXPECT_THAT(records()[0].problem, HasSubstr("exit code 1: "));
  EXPECT_THAT(records()[0].problem, HasSubstr("nonsense"));
  EXPECT_THAT(content(out() / "report.html"), HasSubstr("nonsense"));
}

TEST_F(BenchCommand, BadInputIsRefusedBeforeAnythingRuns) {
  const std::string o = out();
  expect_refused(2, "DIR", {"--out", o});
  expect_refused(2, "no part I/N", {wall(), "--shard", "3/2", "--out", o});
  expect_refused(2, "--modes", {wall(), "--modes", "off,fast", "--out", o});
  expect_refused(2, "--repeat", {wall(), "--repeat", "0", "--out", o});
  expect_refused(2, "--jobs", {wall(), "--jobs", "0", "--out", o});
  expect_refused(1, "no such folder", {folder_ / "nothing", "--out", o});
  expect_refused(1, "no such camera file", {wall(), "--camera", "fr9", "--out", o});
  expect_refused(1, "has no detections.txt", {wall(), "--detector", "boxes", "--out", o});
  expect_refused(1, "has no folder mask", {wall(), "--modes", "masks", "--out", o});
  expect_refused(1, "no YOLOX model", {wall(), "--detector", "yolox", "--out", o});
  expect_refused(1, "two sequences of one name", {wall(), wall(), "--out", o});
  fs::remove(wall() / "camera.yaml");
  expect_refused(1, "--camera", {wall(), "--out", o});
  fs::remove(wall() / "groundtruth.txt");
  expect_refused(1, "no groundtruth.txt", {wall(), "--camera", "fr1", "--out", o});
  expect_refused(1, "holds neither", {folder_, "--out", o});
}

TEST_F(BenchCommand, AnOutputFolderThatCannotBeIsRefused) {
  std::ofstream(out()) << "a file";
  EXPECT_EQ(bench(small("out")), 1);
  EXPECT_THAT(stderr_, HasSubstr("cannot make the output folder"));
}

TEST(BenchShards, TogetherCoverEveryRunOnce) {
  std::vector<apps::BenchJob> jobs(37);
  for (std::size_t i = 0; i < jobs.size(); ++i) jobs[i].seed = i;
  for (const std::size_t count : {1, 2, 5, 36, 37, 40}) {
    std::multiset<std::uint64_t> seeds;
    std::size_t smallest = jobs.size(), largest = 0;
    for (std::size_t index = 1; index <= count; ++index) {
      const auto part = apps::jobs_of_shard(jobs, {index, count});
      for (const auto& job : part) seeds.insert(job.seed);
      smallest = std::min(smallest, part.size());
      largest = std::max(largest, part.size());
    }
    EXPECT_EQ(seeds.size(), jobs.size());
    EXPECT_EQ(std::set<std::uint64_t>(seeds.begin(), seeds.end()).size(), jobs.size());
    EXPECT_LE(largest - smallest, 1U);
  }
}

TEST(BenchShards, AreReadStrictly) {
  EXPECT_EQ(apps::parse_shard("2/8").index, 2U);
  EXPECT_EQ(apps::parse_shard("2/8").count, 8U);
  for (const char* bad : {"", "1", "0/2", "3/2", "-1/2", "1/", "/2", "1/2x", "a/b", "1//2"}) {
    EXPECT_THROW(apps::parse_shard(bad), Error) << bad;
  }
}

TEST_F(BenchCommand, APlanTakesOffOnceAndEveryOtherModeWithEachDetector) {
  std::ofstream(wall() / "detections.txt") << "# none\n";
  apps::BenchPlanOptions options;
  options.folders = {wall()};
  options.modes = {"off", "dkp+", "off", "masks"};
  fs::create_directory(wall() / "mask");
  options.detectors = {"motion", "boxes"};
  options.repeat = 2;
  std::vector<std::string> names;
  std::set<std::string> fingerprints;
  for (const auto& job : apps::plan_jobs(options)) {
    names.push_back(fmt::format("{} {} {}", job.seed, job.mode, job.detector.name));
    fingerprints.insert(apps::options_fingerprint(job));
  }
  EXPECT_THAT(
      names, ::testing::ElementsAre("1 off none", "1 dkp+ motion", "1 dkp+ boxes", "1 masks none",
                                    "2 off none", "2 dkp+ motion", "2 dkp+ boxes", "2 masks none"));
  EXPECT_EQ(fingerprints.size(), names.size());
}

}  // namespace
}  // namespace dkp_slam

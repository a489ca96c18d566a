#include "dkp_slam/evaluation/report/run_record.h"

#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

RunRecord sample() {
  RunRecord r;
  r.sequence = "walking_xyz";
  r.scenario = "walking_xyz";
  r.mode = "dkp+";
  r.detector = "yolox";
  r.model = "yolox_nano.onnx";
  r.seed = 18446744073709551615ULL;
  r.exit_code = 0;
  r.frames = 600;
  r.lost = 3;
  r.ate_m = 0.1 + 0.2;  // needs all 17 digits
  r.ate_deviation_m = 1.0 / 3.0;
  r.rpe_s_m = 0.0123456789012345678;
  r.rpe_s_deg = 0.5;
  r.rpe_frame_m = std::nullopt;
  r.rpe_frame_deg = 1e-9;
  r.features = 612345;
  r.removed = 12345;
  r.keyframes = 51;
  r.landmarks = 1384;
  r.loops_closed = 2;
  r.maps_joined = 1;
  r.maps = 3;
  r.stage_ms = {{"tracking", 7.125}, {"frame", 21.5}};
  r.total_s = 20.25;
  r.processor_s = 33.0;
  r.others_share = 0.015;
  r.peak_memory_mb = 321.5;
  r.jobs = 4;
  r.version = "0.1.0, commit \"x\"";
  r.program = "0123456789abcdef";
  r.options = "fedcba9876543210";
  r.machine = "a processor, 2 cores\nand a line";
  r.date = "2026-01-02T03:04:05Z";
  return r;
}

RunRecord named(const std::string& sequence, const std::string& mode, std::uint64_t seed,
                const std::string& date = "2026-01-01T00:00:00Z") {
  RunRecord r = sample();
  r.sequence = sequence;
  r.scenario = "";
  r.mode = mode;
  r.detector = mode == "off" ? "none" : "motion";
  r.model = "";
  r.seed = seed;
  r.date = date;
  return r;
}

std::vector<std::string> names_of(const std::vector<RunRecord>& records) {
  std::vector<std::string> names;
  for (const RunRecord& r : records) names.push_back(run_name(r));
  return names;
}

class Records : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    file_ = fs::path(::testing::TempDir()) / (std::string("records_") + info->name());
    fs::remove(file_);
  }
  void TearDown() override { fs::remove(file_); }

  fs::path file_;
};

TEST_F(Records, ALineHoldsEveryDigitOfARecord) {
  const RunRecord r = sample();
  const std::string line = to_json_line(r);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const RunRecord back = parse_json_line(line);
  EXPECT_EQ(to_json_line(back), line);
  EXPECT_EQ(back.ate_m, r.ate_m);
  EXPECT_EQ(back.ate_deviation_m, r.ate_deviation_m);
  EXPECT_EQ(back.rpe_s_m, r.rpe_s_m);
  EXPECT_EQ(back.rpe_frame_m, std::nullopt);
  EXPECT_EQ(back.rpe_frame_deg, r.rpe_frame_deg);
  EXPECT_EQ(back.seed, r.seed);
  EXPECT_EQ(back.stage_ms, r.stage_ms);
  EXPECT_EQ(back.machine, r.machine);
  EXPECT_EQ(run_name(back), "walking_xyz/dkp+-yolox-yolox_nano.onnx/seed18446744073709551615");
}

TEST_F(Records, WhatIsNoRecordIsRefused) {
  const std::string good = to_json_line(sample());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    line.replace(line.find(from), from.size(), to);
    return line;
  };
  EXPECT_NO_THROW(parse_json_line(good));
  for (const std::string& line :
       {std::string("{}"), std::string("[1]"), good.substr(0, good.size() / 2),
        with("\"frames\":600", "\"frames\":\"many\""), with("\"frames\":600", "\"frames\":600.5"),
        with("\"frames\":600", "\"frames\":-1"), with("\"frames\":600", "\"frames\":2e51"),
        with("\"jobs\":4", "\"jobs\":3000000000"), with("\"walking_xyz\"", "\"../../etc\""),
        with("\"walking_xyz\"", "\"..\""), with("\"dkp+\"", "\"fast\""),
        with("\"yolox\"", "\"eyes\""), with("\"yolox_nano.onnx\"", "\"a/b\"")}) {
    EXPECT_THROW(parse_json_line(line), Error) << line;
  }
}

TEST_F(Records, AddingAndReadingBack) {
  EXPECT_TRUE(read_records(file_).empty());
  append_record(file_, named("a", "off", 1));
  append_record(file_, named("a", "dkp", 2));
  EXPECT_THAT(names_of(read_records(file_)), ElementsAre("a/off-none/seed1", "a/dkp-motion/seed2"));
}

TEST_F(Records, AWriteThatWasCutOffCostsItsOwnLineOnly) {
  append_record(file_, named("a", "off", 1));
  std::ofstream(file_, std::ios::app) << R"({"sequence":"a","sc)";
  append_record(file_, named("a", "off", 2));
  EXPECT_THAT(names_of(read_records(file_)), ElementsAre("a/off-none/seed1", "a/off-none/seed2"));
}

TEST_F(Records, ManyWritersLeaveWholeLines) {
  std::vector<std::thread> writers;
  constexpr int each = 25;
  for (int writer = 0; writer < 4; ++writer) {
    writers.emplace_back([&, writer] {
      for (int i = 0; i < each; ++i) {
        append_record(file_, named("s", "dk", static_cast<std::uint64_t>(writer * each + i)));
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(latest_records(read_records(file_)).size(), 4U * each);
}

TEST_F(Records, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(append_record(file_ / "nothing" / "here", sample()), Error);
}

TEST_F(Records, TheLatestCountsAndTheOrderIsTheReports) {
  std::vector<RunRecord> records{named("zoo", "off", 1),
                                 named("fr3_walking_xyz", "dkp", 2),
                                 named("fr3_walking_xyz", "dkp", 10),
                                 named("fr3_walking_xyz", "off", 1),
                                 named("walking_xyz", "off", 1),
                                 named("fr3_walking_rpy", "dkp+", 1),
                                 named("zoo", "off", 1, "2026-01-02T00:00:00Z"),
                                 named("zoo", "off", 1)};
  records[0].ate_m = 1.0;
  records[6].ate_m = 2.0;
  records[7].ate_m = 3.0;
  const std::vector<RunRecord> latest = latest_records(records);
  EXPECT_THAT(names_of(latest),
              ElementsAre("fr3_walking_rpy/dkp+-motion/seed1", "fr3_walking_xyz/off-none/seed1",
                          "fr3_walking_xyz/dkp-motion/seed2", "fr3_walking_xyz/dkp-motion/seed10",
                          "walking_xyz/off-none/seed1", "zoo/off-none/seed1"));
  EXPECT_EQ(latest.back().ate_m, 2.0);
}

}  // namespace
}  // namespace dkp_slam

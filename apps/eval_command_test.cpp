#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/report/test_markup.h"
#include "dkp_slam/export/trajectory.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class EvalCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("eval_command_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    Trajectory poses;
    for (int i = 0; i < 90; ++i) {
      Vector6d tangent;
      tangent << 0.01 * i, 0.2, 0.001 * i * i, 0.01 * i, 0.0, 0.1;
      poses.push_back({50.0 + i / 30.0, Se3::exp(tangent)});
    }
    write_trajectory(file("truth.txt"), poses);
    // Every second pose is 2 cm off to one side, the others to the other.
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].world_from_camera.translation.y() += i % 2 == 0 ? 0.02 : -0.02;
    }
    write_trajectory(file("estimate.txt"), poses);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// Runs `dkp-slam eval` with the two trajectories and these options; what it prints.
  std::string run(const std::vector<std::string>& options) const {
    return run_with("truth.txt", "estimate.txt", options);
  }
  std::string run_with(const std::string& truth, const std::string& estimate,
                       const std::vector<std::string>& options) const {
    CLI::App program;
    apps::add_eval_command(program);
    std::vector<std::string> arguments = {"eval", file(truth), file(estimate)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants a vector
    ::testing::internal::CaptureStdout();
    try {
      program.parse(arguments);
    } catch (...) {
      ::testing::internal::GetCapturedStdout();
      throw;
    }
    return ::testing::internal::GetCapturedStdout();
  }

  fs::path folder_;
};

TEST_F(EvalCommand, PrintsTheTable) {
  const std::string text = run({});
  EXPECT_THAT(text, HasSubstr("90 poses, 90 compared"));
  EXPECT_THAT(text, HasSubstr("ATE              m      90   0.01999"));
  EXPECT_THAT(text, HasSubstr("RPE 1 s"));
  EXPECT_THAT(text, HasSubstr("RPE 1 frame"));
}

TEST_F(EvalCommand, JsonToTheStandardOutputStandsAlone) {
  const auto json =
      nlohmann::json::parse(run({"--json", "-", "--rpe-delta", "3", "--rpe-unit", "frames"}));
  EXPECT_NEAR(json.at("ate").at("translation_m").at("rmse").get<double>(), 0.02, 1e-4);
  ASSERT_EQ(json.at("rpe").size(), 1U);
  EXPECT_EQ(json.at("rpe")[0].at("unit"), "f");
  // Three frames on the other side: 4 cm.
  EXPECT_NEAR(json.at("rpe")[0].at("translation_m").at("median").get<double>(), 0.04, 1e-6);
}

TEST_F(EvalCommand, WritesJsonAndPlotsBesideTheTable) {
  EXPECT_THAT(run({"--json", file("e.json"), "--plot", file("e.svg")}), HasSubstr("ATE"));
  run({"--plot", file("e.png")});
  std::ifstream json(file("e.json"));
  EXPECT_EQ(nlohmann::json::parse(json).at("trajectory").at("poses"), 90);
  EXPECT_GT(fs::file_size(file("e.svg")), 1000U);
  std::ifstream png(file("e.png"), std::ios::binary);
  std::string magic(4, ' ');
  png.read(magic.data(), 4);
  EXPECT_EQ(magic, "\x89PNG");
  EXPECT_THAT(run({"--html", file("e.html")}), HasSubstr("ATE"));
  const std::string page = testing::content(file("e.html"));
  const auto charts = testing::charts_of(page);
  ASSERT_EQ(charts.size(), 3U);
  EXPECT_EQ(charts[0].at("series").at(1).at("x").size(), 90U);
}

TEST_F(EvalCommand, FindsAnUnwritableOutputBeforeItReads) {
  try {
    run_with("missing.txt", "estimate.txt", {"--plot", file("no/e.svg")});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("e.svg"));
  }
}

TEST_F(EvalCommand, AStepTheUserAskedForMustBePossible) {
  EXPECT_THROW(run({"--rpe-delta", "10"}), Error);
  EXPECT_NO_THROW(run({"--rpe-delta", "0.5"}));
}

TEST_F(EvalCommand, BadTrajectoriesAreErrors) {
  std::ofstream(file("empty.txt")) << "";
  std::ofstream(file("one.txt")) << "50 0 0 0 0 0 0 1\n";
  std::ofstream(file("nan.txt")) << "50 0 nan 0 0 0 0 1\n";
  for (const char* name : {"missing.txt", "empty.txt", "one.txt", "nan.txt"}) {
    EXPECT_THROW(run_with("truth.txt", name, {}), Error) << name;
    EXPECT_THROW(run_with(name, "estimate.txt", {}), Error) << name;
  }
}

TEST_F(EvalCommand, WrongOptionsAreMisuse) {
  const std::vector<std::vector<std::string>> wrong = {{"--plot", "e.jpg"},
                                                       {"--rpe-unit", "miles"},
                                                       {"--rpe-delta", "nan"},
                                                       {"--rpe-delta", "0"},
                                                       {"--max-difference=-1"},
                                                       {"--offset", "inf"},
                                                       {"--rpe-all-pairs", "--rpe-delta", "1"},
                                                       {"--rpe-max-pairs", "-1"},
                                                       {"--seed", "-1"},
                                                       {"--seed", "18446744073709551616"},
                                                       {"--no-such-option"}};
  for (const auto& options : wrong) {
    EXPECT_THROW(run(options), CLI::ParseError) << options[0] << ' ' << options.back();
  }
  EXPECT_NO_THROW(run({"--offset", "-0.001", "--rpe-all-pairs", "--rpe-max-pairs", "100"}));
}

}  // namespace
}  // namespace dkp_slam

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/synthetic/source.h"
#include "dkp_slam/sensor/tum_source.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

class SynthCommandTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    out_ = fs::path(::testing::TempDir()) / (std::string("synth_") + info->name());
    fs::remove_all(out_);
  }
  void TearDown() override { fs::remove_all(out_); }

  void synth(const std::string& arguments) const {
    CLI::App program;
    add_synth_command(program);
    program.parse("synth " + arguments + " --out \"" + out_.string() + "\"", false);
  }
  static std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path out_;
};

TEST_F(SynthCommandTest, WritesASequenceThatReadsBackAsRendered) {
  synth("walking_static --frames 2 --seed 3 --noise none");
  SyntheticOptions options = synthetic_scenario("walking_static");
  options.seed = 3;
  options.frames = 2;
  options.kinect_noise = false;
  SyntheticSource expected(options);
  const Camera camera = load_camera(out_ / "camera.yaml");
  const auto written = open_tum_folder(out_, camera);
  const Trajectory truth = read_trajectory(out_ / "groundtruth.txt");
  ASSERT_EQ(truth.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const auto a = expected.read(), b = written->read();
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->timestamp, b->timestamp);
    EXPECT_EQ(cv::norm(a->colour, b->colour, cv::NORM_INF), 0.0);
    EXPECT_LE(cv::norm(a->depth, b->depth, cv::NORM_INF), 0.5 / 5000.0 + 1e-6);
    const auto& pose = truth[static_cast<std::size_t>(i)];
    EXPECT_EQ(pose.timestamp, a->timestamp);
    EXPECT_LT((pose.world_from_camera.inverse() * expected.truth().world_from_camera).log().norm(),
              1e-6);
    const fs::path mask = out_ / "mask" / fs::path(i == 0 ? "1000.000000.png" : "1000.033333.png");
    EXPECT_EQ(cv::norm(cv::imread(mask, cv::IMREAD_UNCHANGED), expected.truth().mask, cv::NORM_INF),
              0.0);
  }
  // By time stamps as by associations.txt.
  fs::remove(out_ / "associations.txt");
  EXPECT_EQ(open_tum_folder(out_, camera)->size(), 2U);
}

TEST_F(SynthCommandTest, ReplacesItsOwnFolderButNoOther) {
  fs::create_directories(out_ / "rgb");
  std::ofstream(out_ / "rgb/mine.png") << "precious";
  EXPECT_THROW(synth("static_xyz --frames 1"), Error);
  EXPECT_EQ(content(out_ / "rgb/mine.png"), "precious");
  EXPECT_FALSE(fs::exists(out_ / "synth.json"));
  synth("static_xyz --frames 2 --force");
  EXPECT_FALSE(fs::exists(out_ / "rgb/mine.png"));
  synth("static_xyz --frames 1");  // its own now
  EXPECT_EQ(std::distance(fs::directory_iterator(out_ / "rgb"), {}), 1);
}

TEST_F(SynthCommandTest, MisuseIsAnErrorOfTheCommandLine) {
  EXPECT_THROW(synth("running_xyz"), CLI::ValidationError);
  EXPECT_THROW(synth("walking_xyz --frames 0"), CLI::ValidationError);
  EXPECT_THROW(synth("walking_xyz --noise some"), CLI::ValidationError);
  EXPECT_FALSE(fs::exists(out_));
  std::ofstream(out_) << "a file";
  EXPECT_THROW(synth("walking_xyz --frames 1"), Error);
}

TEST(Progress, PlainLinesAtEveryTenth) {
  const fs::path path = fs::path(::testing::TempDir()) / "progress.txt";
  std::FILE* file = std::fopen(path.c_str(), "w");
  {
    Progress progress("run", 40, file);
    for (std::size_t i = 1; i <= 40; ++i) progress.update(i, "x");
    Progress few("few", 3, file);
    for (std::size_t i = 1; i <= 3; ++i) few.update(i);
  }
  std::fclose(file);
  std::ifstream in(path);
  std::string text, line;
  int lines = 0;
  while (std::getline(in, line)) {
    text = line;
    ++lines;
    if (lines == 2) {
      EXPECT_EQ(line, "run: 4 of 40, x");
    }
    if (lines == 11) {
      EXPECT_EQ(line, "run: 40 of 40, x");
    }
  }
  EXPECT_EQ(lines, 11 + 3);  // the first step, ten tenths, and three
  EXPECT_EQ(text, "few: 3 of 3");
}

}  // namespace
}  // namespace dkp_slam::apps

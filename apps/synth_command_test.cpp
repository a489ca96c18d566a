#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/synth/folder/sequence_writer.h"
#include "dkp_slam/synth/source.h"
#include "tests/support/file_text.h"
#include "tests/support/image_files.h"

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

  fs::path out_;
};

/// Of four frames: a hundred times a second and at every frame.
void expect_truth_at_100_hz(const Trajectory& truth) {
  // 1000.00 to 1000.10 s in steps of 0.01 s, and the frames at thirds of them.
  ASSERT_EQ(truth.size(), 11U + 2U);
  EXPECT_EQ(truth.front().timestamp, 1000.0);
  EXPECT_EQ(truth.back().timestamp, 1000.1);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    EXPECT_LT(truth[i].timestamp - truth[i - 1].timestamp, 0.0101);
  }
}

/// To furnish and light a room takes seconds: one room for all that is to be said of its files.
TEST_F(SynthCommandTest, WritesASequenceThatReadsBackAsRendered) {
  synth("walking_static --frames 4 --seed 3 --noise none");
  SyntheticOptions options = synthetic_scenario("walking_static");
  options.seed = 3;
  options.frames = 4;
  options.kinect_noise = false;
  SyntheticSource expected(options);
  const Camera camera = load_camera(out_ / "camera.yaml");
  const auto written = open_tum_folder(out_, camera);
  const Trajectory truth = read_trajectory(out_ / "groundtruth.txt");
  const auto detector = open_recorded_detections(out_ / "detections.txt", {});
  expect_truth_at_100_hz(truth);
  for (int i = 0; i < 4; ++i) {
    const auto a = expected.read(), b = written->read();
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->timestamp, b->timestamp);
    EXPECT_EQ(cv::norm(a->colour, b->colour, cv::NORM_INF), 0.0);
    EXPECT_LE(cv::norm(a->depth, b->depth, cv::NORM_INF), 0.5 / 5000.0 + 1e-6);
    const std::string file = fmt::format("{:.6f}.png", a->timestamp);
    const cv::Mat mask = testing::read_image(out_ / "mask" / file);
    EXPECT_EQ(cv::norm(mask, expected.truth().mask, cv::NORM_INF), 0.0);
    const cv::Mat instances = testing::read_image(out_ / "instances" / file);
    EXPECT_EQ(instances.type(), CV_8UC1);
    EXPECT_EQ(cv::norm(instances, expected.truth().instance, cv::NORM_INF), 0.0);
    // Both people; the box on the desk has no name.
    const std::vector<Detection> seen = detector->detect(*b);
    ASSERT_EQ(seen.size(), 2U);
    for (const Detection& d : seen) {
      EXPECT_EQ(d.class_id, 0);
      EXPECT_EQ(d.score, 1.0F);
      const bool exact =
          std::any_of(expected.truth().objects.begin(), expected.truth().objects.end(),
                      [&](const SyntheticObject& o) { return cv::Rect2f(o.box) == d.box; });
      EXPECT_TRUE(exact);
    }
    const auto pose = std::find_if(truth.begin(), truth.end(), [&](const StampedPose& p) {
      return p.timestamp == a->timestamp;
    });
    ASSERT_NE(pose, truth.end());
    EXPECT_LT((pose->world_from_camera.inverse() * expected.truth().world_from_camera).log().norm(),
              1e-6);
  }
  // By time stamps as by associations.txt.
  fs::remove(out_ / "associations.txt");
  EXPECT_EQ(open_tum_folder(out_, camera)->size(), 4U);
}

TEST_F(SynthCommandTest, SameSeedSameBytesOfEveryFile) {
  const auto everything = [&](const std::string& arguments) {
    synth(arguments);
    std::map<std::string, std::string> files;
    for (const auto& file : fs::recursive_directory_iterator(out_)) {
      if (file.is_regular_file()) {
        files[fs::relative(file.path(), out_)] = testing::content(file.path());
      }
    }
    return files;
  };
  const auto first = everything("dropped_frames --frames 2 --seed 8 --rolling-shutter");
  EXPECT_EQ(first.size(), 2U * 4U + 7U);
  EXPECT_EQ(everything("dropped_frames --frames 2 --seed 8 --rolling-shutter"), first);
  const auto other = everything("dropped_frames --frames 2 --seed 9 --rolling-shutter");
  EXPECT_NE(other.at("rgb/1000.000000.png"), first.at("rgb/1000.000000.png"));
}

TEST_F(SynthCommandTest, FollowsATrajectoryToItsEnd) {
  const fs::path path = out_.string() + "_path.txt";
  Trajectory poses;
  for (int i = 0; i <= 20; ++i) {
    poses.push_back({5.0 + 0.05 * i, Se3(camera_view(1.0, 0.0, 0.0), {0.01 * i, 3.0, 1.2})});
  }
  write_trajectory(path, poses);
  // One second long, so frame 31 lies beyond; said before anything is written.
  EXPECT_THROW(synth("static_room --frames 32 --trajectory \"" + path.string() + "\""), Error);
  EXPECT_FALSE(fs::exists(out_));
  synth("static_room --frames 2 --trajectory \"" + path.string() + "\"");
  EXPECT_EQ(open_tum_folder(out_, load_camera(out_ / "camera.yaml"))->size(), 2U);
  std::ofstream(path) << "5.0 0 0 zero 0 0 0 1\n";
  try {
    synth("static_room --trajectory \"" + path.string() + "\"");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(path.string() + ":1: tz"), std::string::npos)
        << error.what();
  }
  fs::remove(path);
}

TEST_F(SynthCommandTest, ReplacesItsOwnFolderButNoOther) {
  fs::create_directories(out_ / "rgb");
  std::ofstream(out_ / "rgb/mine.png") << "precious";
  EXPECT_THROW(synth("static_room --frames 1"), Error);
  EXPECT_EQ(testing::content(out_ / "rgb/mine.png"), "precious");
  EXPECT_FALSE(fs::exists(out_ / "synth.json"));
  synth("static_room --frames 2 --force");
  EXPECT_FALSE(fs::exists(out_ / "rgb/mine.png"));
  synth("static_room --frames 1");  // its own now
  EXPECT_EQ(std::distance(fs::directory_iterator(out_ / "rgb"), {}), 1);
}

TEST_F(SynthCommandTest, MisuseIsAnErrorOfTheCommandLine) {
  EXPECT_THROW(synth("running_xyz"), CLI::ValidationError);
  EXPECT_THROW(synth("walking_xyz --frames 0"), CLI::ValidationError);
  EXPECT_THROW(synth("walking_xyz --noise some"), CLI::ValidationError);
  EXPECT_THROW(synth("walking_xyz --seed -1"), CLI::ValidationError);
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

TEST_F(SynthCommandTest, FramesBeforeOneThatCannotBeWrittenAreASequence) {
  SyntheticOptions options = synthetic_scenario("walking_static");
  options.frames = 6;
  options.camera = resized(options.camera, 64, 48);
  SyntheticSource source(options);
  fs::create_directories(out_);
  SequenceWriter writer(out_, options.camera);
  const auto write_all = [&] {
    for (int i = 0; i < 6; ++i) {
      const auto frame = source.read();
      const std::string name = fmt::format("{:.6f}.png", frame->timestamp);
      if (i == 3) fs::create_directories(out_ / "mask" / name / "in the way");
      writer.add(*frame, source.truth());
    }
    writer.finish(source);
  };
  EXPECT_THROW(write_all(), Error);
  writer.finish(source);
  const auto written = open_tum_folder(out_, load_camera(out_ / "camera.yaml"));
  EXPECT_EQ(written->size(), 3U);
  for (const char* folder : {"rgb", "depth", "instances"}) {
    EXPECT_EQ(std::distance(fs::directory_iterator(out_ / folder), {}), 3) << folder;
  }
}

}  // namespace
}  // namespace dkp_slam::apps

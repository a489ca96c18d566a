#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/detection/yolox/tiny_onnx.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/measure/timings.h"
#include "dkp_slam/export/images/image_file.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

/// Runs the program itself, as a user does, on a small exact sequence that each test spoils.
class RunCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
  }

  fs::path out() const { return folder_ / "out"; }
  fs::path camera() const { return sequence_->folder() / "camera.yaml"; }

  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", sequence_->folder(), "--camera", camera(), "--out", out()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Runs to the end; returns the exit code.
  int run(const std::vector<std::string>& more = {"--mode", "off"}) { return call(command(more)); }

  /// Lines of stderr that are neither a message of some level nor progress.
  std::vector<std::string> error_lines() const {
    std::vector<std::string> lines;
    std::istringstream stream(stderr_);
    for (std::string line; std::getline(stream, line);) {
      const bool message = line.starts_with("dkp-slam: info: ") ||
                           line.starts_with("dkp-slam: warning: ") ||
                           line.starts_with("dkp-slam: error: ") || line.starts_with("run: ");
      if (!message) lines.push_back(line);
    }
    return lines;
  }

  /// The run was refused before it began: one line that says why, and nothing written.
  void expect_refused(const std::string& why,
                      const std::vector<std::string>& more = {"--mode", "off"}) {
    EXPECT_EQ(run(more), 1);
    const auto lines = error_lines();
    ASSERT_EQ(lines.size(), 1U) << stderr_;
    EXPECT_THAT(lines[0], HasSubstr("dkp-slam: "));
    EXPECT_THAT(lines[0], HasSubstr(why));
    EXPECT_EQ(stdout_, "");
    EXPECT_FALSE(fs::exists(out()));
  }

  /// The run failed after it began, says why in one line, and left what there was, each file whole.
  void expect_failed(const std::string& why) {
    const auto lines = error_lines();
    ASSERT_EQ(lines.size(), 1U) << stderr_;
    EXPECT_THAT(lines[0], HasSubstr(why));
    EXPECT_THAT(summary().at("failure"), HasSubstr(why));
    expect_whole();
  }
  void expect_whole() const {
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator(out())) names.push_back(file.path().filename());
    std::sort(names.begin(), names.end());
    EXPECT_THAT(names, ::testing::ElementsAre("detections.txt", "keyframes.txt", "summary.json",
                                              "timings.csv", "trajectory.txt"));
  }
  nlohmann::json summary() const { return nlohmann::json::parse(content(out() / "summary.json")); }
  void replace_in_camera(const std::string& from, const std::string& to) const {
    std::string text = content(camera());
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << text;
    text.replace(at, from.size(), to);
    std::ofstream(camera()) << text;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(sequence_->folder() / name) << text;
  }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(RunCommand, LocalisesEveryFrameAndSaysWhereThingsAre) {
  ASSERT_EQ(run({"--mode", "dkp+", "--detector", "none", "--seed", "5"}), 0) << stderr_;
  expect_whole();
  const Trajectory truth = read_trajectory(sequence_->folder() / "groundtruth.txt");
  const Trajectory path = read_trajectory(out() / "trajectory.txt");
  ASSERT_EQ(path.size(), frame_count);
  EXPECT_LT(absolute_error(truth, path).statistics.rmse, 0.002);  // a third of a pixel at 2 m
  const auto json = summary();
  EXPECT_EQ(json.at("frames"), frame_count);
  EXPECT_EQ(json.at("lost_frames"), 0);
  EXPECT_EQ(json.at("detector"), "none");
  EXPECT_EQ(json.at("failure"), "");
  EXPECT_EQ(json.at("options").at("mode"), "dkp+");
  EXPECT_EQ(json.at("options").at("seed"), 5);
  EXPECT_EQ(json.at("options").at("realtime"), false);
  EXPECT_EQ(json.at("options").at("sequence"), sequence_->folder().string());
  EXPECT_NEAR(json.at("ate").at("rmse_m"), absolute_error(truth, path).statistics.rmse, 1e-6);
  EXPECT_GT(json.at("keyframes"), 0);
  EXPECT_GT(json.at("landmarks"), 100);
  EXPECT_GT(json.at("peak_memory_mb"), 10);
  EXPECT_THAT(stdout_, HasSubstr("12 of 12 frames localised, 0 lost"));
  EXPECT_THAT(stdout_, HasSubstr("ATE 0.00"));
  EXPECT_THAT(stdout_, HasSubstr(out().string()));
  const std::string timings = content(out() / "timings.csv");
  EXPECT_EQ(std::count(timings.begin(), timings.end(), '\n'), frame_count + 1);
  const auto columns = read_timings(timings);
  for (int i = 0; i < frame_count; ++i) {
    const auto at = [&](const char* column) {
      return columns.at(column).at(static_cast<std::size_t>(i));
    };
    EXPECT_GT(at("position_sigma_m"), 0.003);
    EXPECT_LT(at("position_sigma_m"), 0.02);
    EXPECT_EQ(at("people_share"), 0.0);
    EXPECT_EQ(at("since_map_seen_s"), 0.0);
  }
  EXPECT_TRUE(error_lines().empty()) << stderr_;
  EXPECT_THAT(stderr_, HasSubstr("run: 12 of 12"));
}

TEST_F(RunCommand, TheSummaryHasTheOptionsThatTheModeUses) {
  ASSERT_EQ(run({"--mode", "paper", "--detector", "none"}), 0) << stderr_;
  const auto paper = summary().at("config").at("dynamics");
  EXPECT_EQ(paper.at("compensation").at("compensate"), false);
  EXPECT_EQ(paper.at("regions").at("printed_equation"), true);
  ASSERT_EQ(run({"--mode", "dkp", "--detector", "none"}), 0) << stderr_;
  const auto ours = summary().at("config").at("dynamics");
  EXPECT_EQ(ours.at("compensation").at("compensate"), true);
  EXPECT_EQ(ours.at("regions").at("printed_equation"), false);
}

TEST_F(RunCommand, SaysWhichDetectorRunsAndHowToGetWeights) {
  ASSERT_EQ(run({}), 0) << stderr_;
  EXPECT_THAT(stderr_, HasSubstr("detector: motion"));
  EXPECT_THAT(stderr_, HasSubstr("scripts/fetch_model.sh"));
  EXPECT_THAT(stderr_, HasSubstr("https://github.com/Megvii-BaseDetection/YOLOX/releases"));
  EXPECT_EQ(summary().at("detector"), "motion");
  EXPECT_THAT(stdout_, HasSubstr("detector motion"));
  ASSERT_EQ(run({"--mode", "off", "--detector", "motion"}), 0);
  EXPECT_THAT(stderr_, HasSubstr("no detector runs (mode off)"));
  EXPECT_EQ(summary().at("detector"), "none");
}

TEST_F(RunCommand, RepeatsWithRecordedDetections) {
  // A person's box in the middle of every image: its features go, in both runs the same ones.
  std::string boxes = "# timestamp class_id score x y width height\n";
  for (const StampedPose& pose : read_trajectory(sequence_->folder() / "groundtruth.txt")) {
    boxes += fmt::format("{:.6f} 0 0.9 200 100 200.25 300\n", pose.timestamp);
  }
  write("boxes.txt", boxes);
  const std::string given = sequence_->folder() / "boxes.txt";
  ASSERT_EQ(run({"--mode", "d", "--detections", given}), 0) << stderr_;
  EXPECT_EQ(summary().at("detector"), "recorded (boxes.txt)");
  EXPECT_EQ(summary().at("detections"), frame_count);
  EXPECT_GT(summary().at("features_removed"), 0);
  const std::string path = content(out() / "trajectory.txt");
  EXPECT_EQ(content(out() / "detections.txt"), boxes);
  fs::rename(out() / "detections.txt", folder_ / "again.txt");
  ASSERT_EQ(run({"--mode", "d", "--one-at-a-time", "--detections", folder_ / "again.txt"}), 0);
  EXPECT_EQ(content(out() / "trajectory.txt"), path);
  EXPECT_EQ(content(out() / "detections.txt"), boxes);
}

TEST_F(RunCommand, DetectionsThatCannotBeRead) {
  expect_refused("boxes.txt: cannot read the detections",
                 {"--detections", sequence_->folder() / "boxes.txt"});
  write("boxes.txt", "1.0 0 0.9 1 2 3\n");
  expect_refused("boxes.txt:1: a line must hold",
                 {"--detections", sequence_->folder() / "boxes.txt"});
  EXPECT_EQ(run({"--detections", "boxes.txt", "--detector", "motion"}), 2);
  EXPECT_EQ(run({"--realtime", "--one-at-a-time"}), 2);
}

TEST_F(RunCommand, OverlayPictures) {
  fs::create_directories(out() / "overlay");
  std::ofstream(out() / "overlay/frame_000777.png") << "an earlier run's";
  std::ofstream(out() / "overlay/mine.png") << "a user's";
  ASSERT_EQ(run({"--detector", "motion", "--overlay", "--overlay-every", "5"}), 0) << stderr_;
  for (const char* name : {"frame_000000.png", "frame_000005.png", "frame_000010.png"}) {
    EXPECT_EQ(testing::read_image(out() / "overlay" / name).size(), cv::Size(640, 480)) << name;
  }
  EXPECT_TRUE(fs::exists(out() / "overlay/mine.png"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out() / "overlay"), {}), 4);
  EXPECT_THAT(stdout_, HasSubstr("3 pictures in overlay/"));
}

TEST_F(RunCommand, RealTimeRunsToTheEnd) {
  ASSERT_EQ(run({"--realtime", "--detector", "motion"}), 0) << stderr_;
  const auto json = summary();
  EXPECT_EQ(json.at("frames").get<int>() + json.at("dropped_frames").get<int>(), frame_count);
  EXPECT_EQ(json.at("options").at("realtime"), true);
}

TEST_F(RunCommand, MisuseOfTheCommandLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {"--mode", "dkq"},        {"--detector", "yolo"},
      {"--provider", "gpu"},    {"--seed", "-1"},
      {"--overlay-every", "5"}, {"--overlay", "--overlay-every", "0"},
      {"--no-such-option"},     {"another"}};
  for (const auto& arguments : wrong) {
    EXPECT_EQ(run(arguments), 2) << arguments[0];
    EXPECT_FALSE(fs::exists(out()));
  }
  const Program bare(folder_, {"run"}, {});
  EXPECT_EQ(bare.wait(), 2);
}

TEST_F(RunCommand, MissingOrEmptyFolder) {
  fs::remove_all(sequence_->folder() / "rgb");
  fs::remove_all(sequence_->folder() / "depth");
  for (const char* list : {"rgb.txt", "depth.txt"}) fs::remove(sequence_->folder() / list);
  expect_refused("no rgb.txt in this folder");
  const fs::path kept = folder_ / "camera.yaml";
  fs::rename(camera(), kept);
  fs::remove_all(sequence_->folder());
  const Program program(
      folder_, {"run", sequence_->folder(), "--camera", kept, "--out", out(), "--mode", "off"}, {});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.err(), HasSubstr("no such folder"));
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(RunCommand, NoDepth) {
  fs::remove(sequence_->folder() / "depth.txt");
  expect_refused("no depth.txt in this folder");
  write("depth.txt", "99.0 depth/99.png\n");
  expect_refused("none of 12 colour images has one of 1 depth images");
}

TEST_F(RunCommand, DepthWithoutAnyReadingLocalisesNothing) {
  for (int i = 0; i < frame_count; ++i) {
    write_image(sequence_->depth_file(i), cv::Mat::zeros(480, 640, CV_16U));
  }
  EXPECT_EQ(run(), 1);
  expect_failed("none of 12 frames was localised");
}

TEST_F(RunCommand, WrongDepthType) {
  write_image(sequence_->depth_file(0), cv::Mat(480, 640, CV_8U, cv::Scalar(100)));
  expect_refused("depth must be a 16-bit image of one channel, not 8 bits");
  write_image(sequence_->depth_file(0), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(100)));
  expect_refused("3 channels");
}

TEST_F(RunCommand, SizesThatDiffer) {
  write_image(sequence_->depth_file(0), cv::Mat(240, 320, CV_16U, cv::Scalar(10000)));
  expect_refused("depth is 320 x 240 pixels but its colour image is 640 x 480");
  write_image(sequence_->colour_file(0), cv::Mat(240, 320, CV_8UC3));
  expect_refused("320 x 240 pixels but the camera file says 640 x 480");
}

TEST_F(RunCommand, ImagesOfTheWrongKindInTheMiddleAreSkippedAndCounted) {
  write_image(sequence_->depth_file(6), cv::Mat(240, 320, CV_16U, cv::Scalar(10000)));
  write_image(sequence_->depth_file(8), cv::Mat(480, 640, CV_8U, cv::Scalar(100)));
  ASSERT_EQ(run(), 0) << stderr_;
  EXPECT_EQ(summary().at("skipped_frames"), 2);
  EXPECT_EQ(summary().at("localised_frames"), frame_count - 2);
  EXPECT_THAT(stderr_, ContainsRegex("warning: .*depth is 320 x 240 pixels.*frame 6 skipped"));
  EXPECT_THAT(stderr_, ContainsRegex("warning: .*not 8 bits.*frame 8 skipped"));
}

TEST_F(RunCommand, UnreadableImagesAreSkippedAndCounted) {
  const auto truncate = [&](const fs::path& file) {
    fs::resize_file(file, fs::file_size(file) / 2);
  };
  truncate(sequence_->colour_file(4));
  truncate(sequence_->depth_file(6));
  fs::remove(sequence_->colour_file(8));
  std::ofstream(sequence_->depth_file(9)) << "no image";
  ASSERT_EQ(run(), 0) << stderr_;
  EXPECT_EQ(summary().at("skipped_frames"), 4);
  EXPECT_EQ(summary().at("localised_frames"), frame_count - 4);
  EXPECT_THAT(stdout_, HasSubstr("4 not readable"));
  for (const char* frame : {"frame 4 ", "frame 6 ", "frame 8 ", "frame 9 "}) {
    EXPECT_THAT(stderr_, ContainsRegex(std::string("warning: .*") + frame + "skipped"));
  }
}

TEST_F(RunCommand, MoreThanHalfUnreadableFails) {
  for (int i = 5; i < frame_count; ++i) fs::remove(sequence_->depth_file(i));
  EXPECT_EQ(run(), 1);
  expect_failed("7 of 12 frames cannot be read");
  EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), 5U);
}

TEST_F(RunCommand, MoreThanHalfLostFails) {
  for (int i = 5; i < frame_count; ++i) {
    write_image(sequence_->colour_file(i), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(128)));
  }
  EXPECT_EQ(run(), 1);
  expect_failed("7 of 12 frames were lost");
  EXPECT_EQ(summary().at("lost_frames"), 7);
  EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), 5U);
}

TEST_F(RunCommand, StampsOutOfOrderOrTwice) {
  std::string first_half, second_half;
  for (int i = 0; i < frame_count; ++i) {
    const std::string line = WallSequence::stamp(i) + " rgb/" + WallSequence::stamp(i) + ".png\n";
    (i < 6 ? first_half : second_half) += line;
    if (i == 3) first_half += line;
  }
  write("rgb.txt", second_half + first_half);
  ASSERT_EQ(run(), 0) << stderr_;
  EXPECT_THAT(stderr_, ContainsRegex("warning: .*order"));
  EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(), frame_count);
  EXPECT_LT(summary().at("ate").at("rmse_m"), 0.002);
  write("rgb.txt", "nan rgb/1.png\n");
  fs::remove_all(out());
  expect_refused("rgb.txt:1");
}

TEST_F(RunCommand, CameraFilesThatMakeNoSense) {
  const std::string good = content(camera());
  const auto line_of = [&](const std::string& key) {
    return 1 +
           std::count(good.begin(), good.begin() + std::ptrdiff_t(good.find("\n" + key)) + 1, '\n');
  };
  const std::string fx =
      good.substr(good.find("fx:"), good.find('\n', good.find("fx:")) - good.find("fx:"));
  const std::string place = fmt::format("camera.yaml:{}: fx", line_of("fx:"));
  for (const char* value : {"fx: nan", "fx: 0", "fx: -500", "fx: wide", "fx: [1, 2]", "fx:"}) {
    std::ofstream(camera()) << good;
    replace_in_camera(fx, value);
    expect_refused(place);
  }
  std::ofstream(camera()) << good;
  replace_in_camera(fx, "fxx: 500");
  expect_refused(fmt::format("camera.yaml:{}: unknown key fxx", line_of("fx:")));
  fs::remove(camera());
  expect_refused("camera.yaml");
}

TEST_F(RunCommand, WithoutACameraFileTheFolderTells) {
  const auto refused = [&](const fs::path& folder, const std::string& why) {
    const Program program(folder_, {"run", folder, "--out", out(), "--mode", "off"}, {});
    EXPECT_EQ(program.wait(), 1);
    EXPECT_THAT(program.err(), HasSubstr(why));
    EXPECT_FALSE(fs::exists(out()));
  };
  const auto camera_used = [&](const fs::path& folder, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"run", folder, "--out", out(), "--mode", "off"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Program program(folder_, arguments, {});
    EXPECT_EQ(program.wait(), 0) << program.err();
    return fs::path(std::string(summary().at("options").at("camera")));
  };
  EXPECT_EQ(camera_used(sequence_->folder(), {}), camera());
  EXPECT_EQ(camera_used(sequence_->folder(), {"--camera", "fr3"}).filename(), "tum_fr3.yaml");
  fs::remove_all(out());

  fs::remove(camera());
  refused(sequence_->folder(), "give one with --camera");
  refused(folder_ / "nothing", "no such folder");
  const fs::path named = folder_ / "rgbd_dataset_freiburg2_wall";
  fs::rename(sequence_->folder(), named);
  EXPECT_EQ(camera_used(named / "", {}).filename(), "tum_fr2.yaml");
  fs::rename(named, sequence_->folder());
}

TEST_F(RunCommand, AModelThatIsNoYolox) {
  std::ofstream(folder_ / "no.onnx") << "this is no model";
  expect_refused("no.onnx", {"--model", folder_ / "no.onnx"});
  tiny_onnx::write_model(folder_ / "other.onnx", 32, 21, 7);  // a network, but YOLOX has 85 columns
  expect_refused("other.onnx", {"--model", folder_ / "other.onnx"});
  expect_refused("missing.onnx", {"--model", folder_ / "missing.onnx"});
  expect_refused("no YOLOX model found", {"--detector", "yolox"});
  std::ofstream(folder_ / "classes.yaml") << "weights:\n  person: many\n";
  expect_refused("classes.yaml:2", {"--classes", folder_ / "classes.yaml", "--detector", "motion"});
}

TEST_F(RunCommand, UnwritableOutputIsFoundBeforeTheRun) {
  std::ofstream(out()) << "a file";
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(stderr_, HasSubstr("cannot make the output folder"));
  EXPECT_THAT(stderr_, Not(HasSubstr("run: ")));
  EXPECT_EQ(content(out()), "a file");
  fs::remove(out());
  fs::create_directories(out() / "summary.json");  // a folder where a file must go
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(stderr_, HasSubstr("summary.json"));
  EXPECT_THAT(stderr_, Not(HasSubstr("run: ")));
  EXPECT_EQ(std::distance(fs::directory_iterator(out()), {}), 1);
  if (::geteuid() != 0) {  // whom no rights stop
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    const Program program = start(command({"--mode", "off"}));
    EXPECT_EQ(program.wait(), 1);
    fs::permissions(folder_, fs::perms::owner_all);
  }
}

TEST_F(RunCommand, CtrlCSavesWhatThereIs) {
  sequence_->prolong([](int) { return frame_count - 1; });
  const Program program = start(command({"--mode", "off", "--realtime"}));
  program.wait_for("run: 1 of");
  program.interrupt();
  EXPECT_EQ(program.wait(), 130);
  stderr_ = program.err();
  expect_failed("interrupted after ");
  EXPECT_EQ(summary().at("interrupted"), true);
  EXPECT_EQ(read_trajectory(out() / "trajectory.txt").size(),
            summary().at("localised_frames").get<std::size_t>());
}

}  // namespace
}  // namespace dkp_slam

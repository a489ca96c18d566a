#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/images/image_file.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;

constexpr int masked_frames = 12;
const cv::Rect half(0, 0, 320, 480);

/// The program on a small exact sequence, with masks that cover the left half of every image, and
/// in real time.
class RunMasks : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", masked_frames);
    cv::Mat mask = cv::Mat::zeros(480, 640, CV_8UC1);
    mask(half) = 1;
    fs::create_directories(masks());
    for (int i = 0; i < masked_frames; ++i) write_image(mask_file(i), mask);
  }

  fs::path out() const { return folder_ / "out"; }
  fs::path masks() const { return sequence_->folder() / "mask"; }
  std::string mask_file(int i) const { return masks() / (WallSequence::stamp(i) + ".png"); }
  int run(const std::vector<std::string>& more) {
    return call({"run", sequence_->folder(), "--out", out()}, more);
  }
  int run_with_masks() { return run({"--masks", masks()}); }
  nlohmann::json summary() const { return nlohmann::json::parse(content(out() / "summary.json")); }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(RunMasks, TakeThePlaceOfADetector) {
  ASSERT_EQ(run({"--masks", masks(), "--overlay"}), 0) << stderr_;
  auto json = summary();
  EXPECT_EQ(json.at("options").at("mode"), "masks");
  EXPECT_EQ(json.at("options").at("masks"), masks().string());
  EXPECT_EQ(json.at("config").at("mode"), "masks");
  EXPECT_EQ(json.at("detector"), "none");
  EXPECT_EQ(json.at("localised_frames"), masked_frames);
  EXPECT_EQ(json.at("frames_without_mask"), 0);
  EXPECT_LT(json.at("ate").at("rmse_m"), 0.005);  // by half of a plane
  const double removed = json.at("features_removed"), features = json.at("features");
  EXPECT_NEAR(removed / features, 0.5, 0.1);
  // In the picture the left half is red.
  const cv::Mat picture = testing::read_image(out() / "overlay/frame_000000.png");
  const cv::Scalar left = cv::mean(picture(half)),
                   right = cv::mean(picture(half + cv::Point(320, 0)));
  EXPECT_GT(left[2] - left[1], right[2] - right[1] + 20.0);
  // The masks' folder repeats the run.
  const std::string path = content(out() / "trajectory.txt");
  ASSERT_EQ(run({"--mode", "masks", "--masks", masks()}), 0) << stderr_;
  EXPECT_EQ(content(out() / "trajectory.txt"), path);
}

TEST_F(RunMasks, SomeThatAreMissingAreSaidOnceAndCounted) {
  for (const int i : {3, 4, 9}) fs::remove(mask_file(i));
  ASSERT_EQ(run_with_masks(), 0) << stderr_;
  EXPECT_EQ(summary().at("frames_without_mask"), 3);
  EXPECT_THAT(stdout_, HasSubstr("3 without mask"));
  const std::string name = WallSequence::stamp(3) + ".png: no such mask";
  const std::size_t first = stderr_.find("no such mask");
  EXPECT_THAT(stderr_, HasSubstr(name));
  EXPECT_EQ(stderr_.find("no such mask", first + 1), std::string::npos);
}

TEST_F(RunMasks, WhatIsWrongAtOnceWritesNothing) {
  const auto expect_refused = [&](const std::string& why) {
    EXPECT_EQ(run_with_masks(), 1);
    EXPECT_THAT(stderr_, HasSubstr("dkp-slam: "));
    EXPECT_THAT(stderr_, HasSubstr(why));
    EXPECT_FALSE(fs::exists(out()));
  };
  write_image(mask_file(0), cv::Mat::zeros(240, 320, CV_8UC1));
  expect_refused(mask_file(0) + ": the mask is 320 x 240 pixels");
  write_image(mask_file(0), cv::Mat::zeros(480, 640, CV_16UC1));
  expect_refused(mask_file(0) + ": not of 8-bit grey values");
  for (int i = 0; i < masked_frames; ++i) fs::remove(mask_file(i));
  expect_refused("holds no mask for any of 12 colour images");
  fs::remove_all(masks());
  expect_refused("mask: no such folder");
}

TEST_F(RunMasks, OneOfAnotherSizeInTheMiddleEndsTheRunAndKeepsWhatThereIs) {
  write_image(mask_file(6), cv::Mat::zeros(240, 320, CV_8UC1));
  EXPECT_EQ(run_with_masks(), 1);
  EXPECT_THAT(stderr_, HasSubstr(mask_file(6) + ": the mask is 320 x 240 pixels"));
  EXPECT_EQ(summary().at("localised_frames"), 6);
}

TEST_F(RunMasks, MasksThatCoverEverythingFailTheRun) {
  for (int i = 0; i < masked_frames; ++i) {
    write_image(mask_file(i), cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
  }
  EXPECT_EQ(run_with_masks(), 1);
  EXPECT_THAT(stderr_, HasSubstr("none of 12 frames was localised"));
}

TEST_F(RunMasks, GoWithNoDetectorAndNoOtherMode) {
  const std::string dir = masks();
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--masks", dir, "--detector", "motion"},
                                             {"--masks", dir, "--model", "yolox.onnx"},
                                             {"--masks", dir, "--detections", "boxes.txt"},
                                             {"--masks", dir, "--mode", "dk"},
                                             {"--mode", "masks"}}) {
    EXPECT_EQ(run(more), 2) << stderr_;
    EXPECT_THAT(stderr_, HasSubstr("masks"));
    EXPECT_FALSE(fs::exists(out()));
  }
}

TEST_F(RunMasks, RealTimeAtAnotherRate) {
  ASSERT_EQ(run({"--realtime", "--rate", "2.5", "--masks", masks()}), 0) << stderr_;
  const auto json = summary();
  EXPECT_EQ(json.at("options").at("rate"), 2.5);
  EXPECT_EQ(json.at("frames").get<int>() + json.at("dropped_frames").get<int>(), masked_frames);
  // Time stamps are those of the recording.
  const Trajectory path = read_trajectory(out() / "trajectory.txt");
  for (const StampedPose& pose : path) {
    const double frame = (pose.timestamp - 10.0) * 30.0;
    EXPECT_NEAR(frame, std::round(frame), 1e-3);
  }
  ASSERT_EQ(run({"--masks", masks()}), 0) << stderr_;
  EXPECT_EQ(summary().at("options").at("rate"), nullptr) << "nothing is played by time";
}

TEST_F(RunMasks, ARateNeedsRealTimeAndBounds) {
  EXPECT_EQ(run({"--rate", "2"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("--realtime"));
  for (const char* wrong : {"0", "-1", "100.5", "nan", "fast"}) {
    EXPECT_EQ(run({"--realtime", "--rate", wrong}), 2) << wrong;
    EXPECT_THAT(stderr_, HasSubstr("--rate")) << wrong;
  }
  EXPECT_FALSE(fs::exists(out()));
}

}  // namespace
}  // namespace dkp_slam

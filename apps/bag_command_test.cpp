#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "dkp_slam/sensor/tum_source.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::TestBag;
using dkp_slam::testing::WallSequence;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The program, given a bag.
class BagCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
  }
  std::string bag() const { return folder_ / "wall.bag"; }
  void write_bag(const std::string& depth_encoding = "16UC1") const {
    TestBag out(bag());
    const Camera& camera = sequence_->camera;
    out.info("/camera/rgb/camera_info", 10.0, {camera.width, camera.height}, camera.fx);
    const auto source = open_tum_folder(sequence_->folder(), camera);
    while (const auto frame = source->read()) {
      cv::Mat millimetres;
      frame->depth.convertTo(millimetres, CV_16U, 1000.0);
      out.image("/camera/rgb/image_color", frame->timestamp, frame->colour, "bgr8");
      out.image("/camera/depth/image", frame->timestamp, millimetres, depth_encoding);
    }
  }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(BagCommand, RunFindsTheSamePathAsInTheFolder) {
  write_bag();
  const auto path_of = [&](const std::string& sequence, const fs::path& out) {
    EXPECT_EQ(call({"run", sequence, "--mode", "off", "--out", out}), 0) << stderr_;
    return read_trajectory(out / "trajectory.txt");
  };
  const Trajectory of_bag = path_of(bag(), folder_ / "of_bag");
  EXPECT_THAT(stderr_,
              AllOf(HasSubstr("/camera/rgb/image_color"), HasSubstr("/camera/depth/image")));
  const Trajectory of_folder = path_of(sequence_->folder(), folder_ / "of_folder");
  ASSERT_EQ(of_bag.size(), static_cast<std::size_t>(frame_count));
  ASSERT_EQ(of_folder.size(), of_bag.size());
  for (std::size_t i = 0; i < of_bag.size(); ++i) {
    EXPECT_NEAR(of_bag[i].timestamp, of_folder[i].timestamp, 1e-6);
    const Se3 difference = of_bag[i].world_from_camera.inverse() * of_folder[i].world_from_camera;
    EXPECT_NEAR(difference.translation.norm(), 0.0, 1e-5);
  }
}

TEST_F(BagCommand, RecordMakesAFolderOfIt) {
  write_bag();
  ASSERT_EQ(call({"record", bag(), "--out", folder_ / "copy", "--topics",
                  "/camera/rgb/image_color,/camera/depth/image"}),
            0)
      << stderr_;
  EXPECT_THAT(stdout_, HasSubstr(fmt::format("{} frames in ", frame_count)));
  const auto copy = open_tum_folder(folder_ / "copy", load_camera(folder_ / "copy/camera.yaml"));
  const auto original = open_tum_folder(sequence_->folder(), sequence_->camera);
  for (int i = 0; i < frame_count; ++i) {
    const auto a = copy->read(), b = original->read();
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->timestamp, b->timestamp, 1e-6);
    EXPECT_EQ(cv::norm(a->colour, b->colour, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(a->depth, b->depth, cv::NORM_INF), 0.0);
  }
}

TEST_F(BagCommand, TheDenseMapIsMadeOfItToo) {
  write_bag();
  const fs::path out = folder_ / "out", cloud = folder_ / "cloud.ply";
  ASSERT_EQ(call({"run", bag(), "--mode", "off", "--save-masks", "--out", out, "--topics",
                  "/camera/rgb/image_color,/camera/depth/image"}),
            0)
      << stderr_;
  // Topics and camera are those of the run.
  ASSERT_EQ(call({"export", out, "--dense", cloud, "--voxel", "0.04"}), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr(fmt::format("{} images fused", frame_count)));
  EXPECT_GT(fs::file_size(cloud), 50'000U);
  EXPECT_EQ(call({"export", out, "--dense", cloud, "--masks", folder_}), 1);
  EXPECT_THAT(stderr_, HasSubstr("--masks needs images with names"));
  fs::remove(bag());
  EXPECT_EQ(call({"export", out, "--dense", cloud}), 1);
  EXPECT_THAT(stderr_, HasSubstr("wall.bag: no such folder or bag"));
}

TEST_F(BagCommand, WhatIsWrongIsOneLineAndLeavesNothing) {
  const fs::path out = folder_ / "out";
  const auto expect_refusal = [&](const std::vector<std::string>& options, int code,
                                  const std::string& reason) {
    EXPECT_EQ(call({"run", bag(), "--mode", "off", "--out", out}, options), code) << reason;
    EXPECT_THAT(stderr_, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(out)) << reason;
  };
  expect_refusal({}, 1, "wall.bag: no such file");
  write_bag("8UC4");
  expect_refusal({}, 1, "/camera/depth/image: its encoding \"8UC4\" is not known for depth");
  expect_refusal({"--topics", "/camera/rgb/image_color"}, 1, "must be COLOUR,DEPTH");
  expect_refusal({"--topics", "/camera/rgb/image_color,/depth"}, 1, "has no images in /depth");
  expect_refusal({"--masks", folder_}, 2, "--masks: not with a bag");
  write_bag();
  fs::resize_file(bag(), fs::file_size(bag()) / 2);
  expect_refusal({}, 1, "cut off");
}

}  // namespace
}  // namespace dkp_slam

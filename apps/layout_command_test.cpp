#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "apps/test_command.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/depth_registration.h"
#include "dkp_slam/sensor/image_reader.h"
#include "tests/support/image_files.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::Recording;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int frame_count = 24;
constexpr double rate = 30.0;

std::string matrix_text(const Eigen::Matrix4d& m) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    text +=
        fmt::format("{:.9e}\t{:.9e}\t{:.9e}\t{:.9e}\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  }
  return text;
}

Eigen::Matrix4d matrix_of(const Se3& pose) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = pose.translation;
  return m;
}

std::string intrinsics_text(double fx, double fy, double cx, double cy) {
  return fmt::format("{} 0 {} 0\n0 {} {} 0\n0 0 1 0\n0 0 0 1\n", fx, cx, fy, cy);
}

/// The program, given a generated room as each dataset would have written it.
class LayoutCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = folder_ / "sequence";
    out_ = folder_ / "out";
  }
  static const Recording& room() {
    static const Recording recording("static_room", frame_count);
    return recording;
  }
  static StampedPose pose_at(std::size_t frame) {
    const double time = room().frames[frame].timestamp;
    StampedPose nearest = room().truth.front();
    for (const StampedPose& pose : room().truth) {
      if (std::abs(pose.timestamp - time) < std::abs(nearest.timestamp - time)) nearest = pose;
    }
    return nearest;
  }
  /// Where the camera was, image N at N / rate seconds.
  static Trajectory truth() {
    Trajectory path;
    for (std::size_t i = 0; i < frame_count; ++i) {
      path.push_back({static_cast<double>(i) / rate, pose_at(i).world_from_camera});
    }
    return path;
  }
  void image(const fs::path& name, const cv::Mat& pixels) const {
    fs::create_directories((sequence_ / name).parent_path());
    testing::write_image_as_named(sequence_ / name, pixels);
  }
  void text(const fs::path& name, const std::string& lines) const {
    fs::create_directories((sequence_ / name).parent_path());
    std::ofstream(sequence_ / name) << lines;
  }
  /// Runs it; the error of the path, metres RMSE.
  double error_of_run(const fs::path& sequence) {
    EXPECT_EQ(call({"run", sequence, "--mode", "off", "--out", out_}), 0) << stderr_;
    const Trajectory path = read_trajectory(out_ / "trajectory.txt");
    EXPECT_EQ(path.size(), static_cast<std::size_t>(frame_count));
    return absolute_error(truth(), path).statistics.rmse;
  }
  /// Path, truth at the run's end, the dense map, `eval` of the folder, and a recorded copy that
  /// does the same.
  void expect_right_path(const std::string& layout) {
    constexpr double most = 0.01;  // metres; measured: .0016 to .0017
    const double error = error_of_run(sequence_);
    EXPECT_LT(error, most);
    EXPECT_THAT(stderr_,
                HasSubstr(fmt::format("{} frames in the layout of {}", frame_count, layout)));
    EXPECT_THAT(stdout_, HasSubstr(fmt::format("ATE {:.4f} m (RMSE, {} poses, by the truth of the "
                                               "sequence)",
                                               error, frame_count)));
    const fs::path cloud = folder_ / "cloud.ply";
    ASSERT_EQ(
        call({"export", out_, "--dense", cloud, "--no-masks", "--voxel", "0.05", "--every", "6"}),
        0)
        << stderr_;
    EXPECT_THAT(stdout_, HasSubstr("4 images fused"));
    ASSERT_EQ(call({"eval", sequence_, out_ / "trajectory.txt"}), 0) << stderr_;
    EXPECT_THAT(stdout_, HasSubstr(fmt::format("{:.6f}", error)));
    ASSERT_EQ(call({"record", sequence_, "--out", folder_ / "copy"}), 0) << stderr_;
    EXPECT_TRUE(fs::exists(folder_ / "copy/groundtruth.txt"));
    EXPECT_LT(error_of_run(folder_ / "copy"), most);
    EXPECT_THAT(stdout_, HasSubstr("by the truth of the sequence"));
  }

  fs::path sequence_, out_;
};

TEST_F(LayoutCommand, IclNuim) {
  const Camera& camera = room().camera;
  std::string lines;
  for (std::size_t i = 0; i < frame_count; ++i) {
    image(fmt::format("rgb/{}.png", i), room().frames[i].colour);
    image(fmt::format("depth/{}.png", i), depth_in_units(room().frames[i].depth, 5000.0));
    // With y up in camera and world, as the ray tracer has them.
    const Se3 pose = truth()[i].world_from_camera;
    const Eigen::Vector3d& t = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    lines += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", i, t.x(), -t.y(),
                         t.z(), -q.x(), q.y(), -q.z(), q.w());
  }
  text("livingRoom9.gt.freiburg", lines);
  Camera theirs = camera;
  theirs.depth_scale = 5000.0;
  save_camera(theirs, sequence_ / "camera.yaml");
  expect_right_path("ICL-NUIM");
  // Without that the camera is the published one, whose images have that size, too.
  fs::remove(sequence_ / "camera.yaml");
  call({"run", sequence_, "--mode", "off", "--out", out_});
  EXPECT_THAT(stderr_, HasSubstr("icl_nuim.yaml"));
  fs::remove(sequence_ / "livingRoom9.gt.freiburg");
  EXPECT_EQ(call({"run", sequence_, "--mode", "off", "--out", folder_ / "none"}), 1);
  EXPECT_THAT(stderr_, AllOf(HasSubstr("has no camera.yaml"), HasSubstr("icl, 7scenes")));
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(LayoutCommand, SevenScenes) {
  Camera depth_camera;
  depth_camera.fx = depth_camera.fy = 585.0;
  depth_camera.cx = 320.0;
  depth_camera.cy = 240.0;
  const Se3 depth_from_colour{Eigen::Quaterniond::Identity(), {0.025, 0.0, 0.0}};
  const DepthRegistration seen(room().camera, depth_camera, depth_from_colour);
  for (std::size_t i = 0; i < frame_count; ++i) {
    cv::Mat units = depth_in_units(seen.registered(room().frames[i].depth), 1000.0);
    units.setTo(65535, units == 0);
    const std::string name = fmt::format("frame-{:06}", i);
    image(name + ".color.png", room().frames[i].colour);
    image(name + ".depth.png", units);
    text(name + ".pose.txt",
         matrix_text(matrix_of(truth()[i].world_from_camera * depth_from_colour.inverse())));
  }
  Camera theirs = room().camera;
  theirs.depth_scale = 1000.0;
  save_camera(theirs, sequence_ / "camera.yaml");
  expect_right_path("7-Scenes");
  // A pose that is none is said; the run does without the truth.
  text("frame-000001.pose.txt", "1 2 3\n");
  EXPECT_EQ(call({"run", sequence_, "--mode", "off", "--out", out_}), 0);
  EXPECT_THAT(stderr_, HasSubstr("not compared with the truth"));
  EXPECT_EQ(call({"eval", sequence_, out_ / "trajectory.txt"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("frame-000001.pose.txt: has 3 numbers"));
}

TEST_F(LayoutCommand, ScanNet) {
  // Depth of half the width; its pixels' centres are those of colour's pixels 2 u + 0.5. Lens and
  // shutter of the room's camera are none that ScanNet exports.
  const Camera& camera = room().camera;
  for (std::size_t i = 0; i < frame_count; ++i) {
    cv::Mat half;
    cv::resize(room().frames[i].depth, half, {}, 0.5, 0.5, cv::INTER_NEAREST);
    image(fmt::format("color/{}.jpg", i), room().frames[i].colour);
    image(fmt::format("depth/{}.png", i), depth_in_units(half, 1000.0));
    text(fmt::format("pose/{}.txt", i), matrix_text(matrix_of(truth()[i].world_from_camera)));
  }
  text("intrinsic/intrinsic_color.txt",
       intrinsics_text(camera.fx, camera.fy, camera.cx, camera.cy));
  text("intrinsic/intrinsic_depth.txt",
       intrinsics_text(0.5 * camera.fx, 0.5 * camera.fy, 0.5 * (camera.cx - 0.5),
                       0.5 * (camera.cy - 0.5)));
  expect_right_path("ScanNet");
  EXPECT_THAT(content(folder_ / "copy/camera.yaml"), HasSubstr("width: 320"));
  fs::remove(sequence_ / "intrinsic/intrinsic_depth.txt");
  EXPECT_EQ(call({"run", sequence_, "--mode", "off", "--out", folder_ / "none"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("no intrinsic/intrinsic_depth.txt"));
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(LayoutCommand, TheRateIsTheUsersToSay) {
  for (int i = 0; i < 3; ++i) {
    image(fmt::format("rgb/{}.png", i), room().frames[0].colour);
    image(fmt::format("depth/{}.png", i), depth_in_units(room().frames[0].depth, 5000.0));
  }
  save_camera(room().camera, sequence_ / "camera.yaml");
  ASSERT_EQ(call({"record", sequence_, "--frame-rate", "10", "--out", out_}), 0) << stderr_;
  EXPECT_THAT(content(out_ / "associations.txt"), HasSubstr("0.200000 rgb/0.200000.png"));
  EXPECT_EQ(call({"record", sequence_, "--frame-rate", "0", "--out", folder_ / "other"}), 2);
  EXPECT_EQ(call({"eval", sequence_, out_ / "trajectory.txt"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("this folder brings no true path"));
}

}  // namespace
}  // namespace dkp_slam

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "apps/test_command.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/tum_source.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::Program;
using dkp_slam::testing::Recording;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int room_frames = 24;
constexpr double rate = 30.0;

/// The program with a Kinect: fakenect, the stand-in library that plays a recording to it.
class KinectCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    recording_ = folder_ / "recording";
    environment_ = {"LD_LIBRARY_PATH=" DKP_SLAM_FAKENECT, "FAKENECT_PATH=" + recording_.string()};
    fs::create_directories(recording_);
    save_camera(room().camera, folder_ / "camera.yaml");
    for (int i = 0; i < room_frames; ++i) write_images(i);
  }
  static const Recording& room() {
    static const Recording recording("static_room", room_frames);
    return recording;
  }
  /// There and back, again and again, so that the camera never jumps.
  static std::size_t seen_in(int frame) {
    const int place = frame % (2 * room_frames - 2);
    return static_cast<std::size_t>(place < room_frames ? place : 2 * room_frames - 2 - place);
  }
  void write_images(int i) const {
    const RgbdFrame& frame = room().frames[static_cast<std::size_t>(i)];
    cv::Mat rgb;
    cv::cvtColor(frame.colour, rgb, cv::COLOR_BGR2RGB);
    const cv::Mat units = depth_in_units(frame.depth, 1000.0);
    const auto write = [this, i](const char* name, const std::string& head, const cv::Mat& image) {
      std::ofstream file(folder_ / fmt::format("{}{}", name, i), std::ios::binary);
      file << head;
      file.write(reinterpret_cast<const char*>(image.data),
                 static_cast<std::streamsize>(image.total() * image.elemSize()));
    };
    write("rgb", "P6 640 480 255 \n", rgb);
    write("depth", "P5 640 480 65535 \n", units);
  }
  /// A recording as fakenect-record makes it, of so many frames: depth comes 4 ms after colour, the
  /// counter begins anew in it, and it ends in what tells the library that the device is gone.
  /// `gone_before`: frames before which that happens, too, and it is back 0.3 s later.
  void write_recording(int frames, const std::vector<int>& gone_before = {}) const {
    std::string index;
    const auto add = [&](char kind, double time, std::uint32_t ticks, const fs::path& content) {
      const std::string name =
          fmt::format("{}-{:.6f}-{}.{}", kind, time, ticks, kind == 'r' ? "ppm" : "pgm");
      if (content.empty()) {
        std::ofstream(recording_ / name).flush();
      } else {
        fs::create_hard_link(content, recording_ / name);
      }
      index += name + '\n';
    };
    std::uint32_t ticks = 0U - 10 * 2'000'000U;
    double time = 1000.0;
    for (int i = 0; i < frames; ++i, ticks += 2'000'000U, time += 1.0 / rate) {
      if (std::find(gone_before.begin(), gone_before.end(), i) != gone_before.end()) {
        add('d', time, ticks + 1, {});
        ticks = 12345;  // a device that was opened begins to count
        time += 0.3;
      }
      add('r', time, ticks, folder_ / fmt::format("rgb{}", seen_in(i)));
      add('d', time + 0.004, ticks + 240'000U, folder_ / fmt::format("depth{}", seen_in(i)));
    }
    std::ofstream(recording_ / "INDEX.txt") << index;
  }
  /// Every frame of the recording, as it was, at 30 Hz; returns the stamps.
  std::vector<double> expect_frames(const fs::path& out, int frames) const {
    std::vector<double> stamps;
    const auto source = open_tum_folder(out, load_camera(out / "camera.yaml"));
    EXPECT_EQ(source->size(), static_cast<std::size_t>(frames));
    while (const auto frame = source->read()) {
      const RgbdFrame& made = room().frames[seen_in(static_cast<int>(stamps.size()))];
      EXPECT_EQ(cv::norm(frame->colour, made.colour, cv::NORM_INF), 0.0);
      EXPECT_LE(cv::norm(frame->depth, made.depth, cv::NORM_INF), 0.0006);
      EXPECT_NEAR(frame->depth_delay, 0.004, 2e-6);
      stamps.push_back(frame->timestamp);
    }
    return stamps;
  }
  /// Error of a path whose first pose is that of the first frame, metres RMSE.
  static double error_of(const Trajectory& path, int frames) {
    Trajectory truth;
    for (int i = 0; i < frames; ++i) {
      const double taken = room().frames[seen_in(i)].timestamp;
      for (const StampedPose& pose : room().truth) {
        if (std::abs(pose.timestamp - taken) > 1e-4) continue;
        truth.push_back({path.front().timestamp + i / rate, pose.world_from_camera});
        break;
      }
    }
    return absolute_error(truth, path).statistics.rmse;
  }

  fs::path recording_;
};

TEST_F(KinectCommand, RecordDropsNoFrameAndThePathIsRight) {
  constexpr int frames = 90;
  write_recording(frames);
  const fs::path out = folder_ / "out";
  const Program program =
      start({"record", "--source", "kinect", "--camera", folder_ / "camera.yaml", "--frames",
             std::to_string(frames), "--out", out});
  ASSERT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(program.out(),
              AllOf(HasSubstr("90 frames in "), HasSubstr("at 30.0 Hz, 33 ms at most"),
                    HasSubstr("; 0 dropped")));
  EXPECT_THAT(program.err(), Not(HasSubstr("lost")));
  const std::vector<double> stamps = expect_frames(out, frames);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    EXPECT_NEAR(stamps[i] - stamps[i - 1], 1.0 / rate, 2e-6);
  }
  const Program run = start({"run", out, "--mode", "off", "--out", folder_ / "path"});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_LT(error_of(read_trajectory(folder_ / "path/trajectory.txt"), frames), 0.01);
}

TEST_F(KinectCommand, RunFindsThePathLive) {
  constexpr int frames = 60;
  write_recording(frames);
  const fs::path out = folder_ / "out";
  const Program program = start({"run", "--source", "kinect", "--camera", folder_ / "camera.yaml",
                                 "--mode", "off", "--reconnect", "0.5", "--out", out});
  // The recording's end is that of the device.
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.err(), HasSubstr("no image came for 0.5 s (--reconnect)"));
  const Trajectory path = read_trajectory(out / "trajectory.txt");
  // In real time, so that a busy machine drops some, and a sanitizer most.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr std::size_t least = frames / 6;
#else
  constexpr std::size_t least = frames / 2;
#endif
  EXPECT_GT(path.size(), least);
  EXPECT_LT(error_of(path, frames), 0.02);
}

TEST_F(KinectCommand, WhatIsUnpluggedComesBack) {
  constexpr int frames = 24;
  write_recording(frames, {8, 16});
  const fs::path out = folder_ / "out";
  const Program program =
      start({"record", "--source", "kinect", "--camera", folder_ / "camera.yaml", "--frames",
             std::to_string(frames), "--out", out});
  ASSERT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(
      program.err(),
      AllOf(HasSubstr("kinect: was unplugged or broke off; waiting 30 s for it to come back"),
            HasSubstr("kinect: is there again"), Not(HasSubstr("lost"))));
  const std::vector<double> stamps = expect_frames(out, frames);
  ASSERT_EQ(stamps.size(), static_cast<std::size_t>(frames));
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double step = stamps[i] - stamps[i - 1];
    if (i == 8 || i == 16) {
      EXPECT_GT(step, 0.09);  // away for a while, by the host's clock
    } else {
      EXPECT_NEAR(step, 1.0 / rate, 2e-6);
    }
  }
}

TEST_F(KinectCommand, CtrlCIsTheEndOfARecording) {
  constexpr int frames = 12;
  write_recording(frames);
  const fs::path out = folder_ / "out";
  const Program program =
      start({"record", "--source", "kinect", "--camera", folder_ / "camera.yaml", "--out", out});
  program.wait_for("waiting 30 s for it to come back");
  program.interrupt();
  EXPECT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(program.out(), HasSubstr("12 frames in "));
  expect_frames(out, frames);
}

TEST_F(KinectCommand, WhatNeverComesIsCounted) {
  constexpr int frames = 12;
  write_recording(frames);
  // Two depth images are missing.
  std::ifstream in(recording_ / "INDEX.txt");
  std::string line, index;
  for (int depth = 0; std::getline(in, line);) {
    if (line[0] != 'd' || (++depth != 5 && depth != 6)) index += line + '\n';
  }
  std::ofstream(recording_ / "INDEX.txt") << index;
  const Program program =
      start({"record", "--source", "kinect", "--camera", folder_ / "camera.yaml", "--frames", "10",
             "--out", folder_ / "out"});
  ASSERT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(program.err(), HasSubstr("kinect: 2 frames were lost"));
}

TEST_F(KinectCommand, WhatIsWrongIsOneLine) {
  write_recording(2);
  const fs::path out = folder_ / "out";
  const auto expect_refusal = [&](const std::vector<std::string>& options, int code,
                                  const std::string& reason) {
    std::vector<std::string> arguments{"run", "--mode", "off", "--out", out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Program program = start(arguments);
    EXPECT_EQ(program.wait(), code) << reason;
    EXPECT_THAT(program.err(), HasSubstr(reason));
    EXPECT_FALSE(fs::exists(out)) << reason;
  };
  expect_refusal({"--source", "kinect:1"}, 1, "kinect:1: 1 are plugged in");
  expect_refusal({"--source", "kinect:x"}, 1, "kinect:x: is no Kinect's name");
  expect_refusal({"--source", "kinect", "--offline"}, 2, "not with a Kinect");
  expect_refusal({"--source", "kinect", "--preload"}, 2, "--preload");
  Camera small = room().camera;
  small.width = 320;
  small.cx = 160.0;
  save_camera(small, folder_ / "small.yaml");
  expect_refusal({"--source", "kinect", "--camera", folder_ / "small.yaml"}, 1,
                 "kinect: its images are 640 x 480 pixels but the camera file says 320 x 480");
}

}  // namespace
}  // namespace dkp_slam

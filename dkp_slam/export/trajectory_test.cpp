#include "dkp_slam/export/trajectory.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class TrajectoryFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path(::testing::TempDir()) /
            (std::string("trajectory_") +
             ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt");
    fs::remove(path_);
  }
  void TearDown() override { fs::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  std::string content() const { return testing::content(path_); }
  /// Message of the error that reading this text gives.
  std::string error_of(const std::string& text) const {
    write(text);
    try {
      read_trajectory(path_);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path path_;
};

TEST_F(TrajectoryFile, ReadsBlanksTabsCommasCommentsAndWindowsLineEnds) {
  write("# comment\r\n\n1.5 1 2 3 0 0 0 1\r\n  # indented\n2.5,\t-1e-1, +2,3.0,0,0,0.5,0.5\n");
  const Trajectory poses = read_trajectory(path_);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_DOUBLE_EQ(poses[0].timestamp, 1.5);
  EXPECT_TRUE(poses[0].world_from_camera.translation.isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(poses[1].world_from_camera.translation.isApprox(Eigen::Vector3d(-0.1, 2, 3)));
  EXPECT_NEAR(poses[1].world_from_camera.angle(), M_PI / 2, 1e-12) << "quaternion is normalised";
  EXPECT_TRUE((poses[1].world_from_camera.rotation * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST_F(TrajectoryFile, ADeviceIsNoFile) {
  EXPECT_THAT([] { read_trajectory("/dev/zero"); },
              ::testing::ThrowsMessage<Error>(HasSubstr("is a device")));
}

TEST_F(TrajectoryFile, WritesTheseBytes) {
  Trajectory poses(2);
  poses[0].timestamp = 1305031102.1753041;
  poses[0].world_from_camera.translation = {1.0, -2.25, 0.123456789};
  poses[1].timestamp = 1305031102.25;
  poses[1].world_from_camera.rotation = Eigen::Quaterniond(-0.5, 0.5, 0.5, -0.5);
  write_trajectory(path_, poses);
  EXPECT_EQ(content(),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1305031102.175304 1.0000000 -2.2500000 0.1234568 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n"
            "1305031102.250000 0.0000000 0.0000000 0.0000000 -0.500000000 -0.500000000 0.500000000 "
            "0.500000000\n");
}

TEST_F(TrajectoryFile, WhatIsWrittenReadsBackAndTheSamePosesGiveTheSameBytes) {
  Trajectory poses;
  for (int i = 0; i < 50; ++i) {
    Vector6d tangent;
    tangent << 0.1 * i, std::sin(i), -0.05 * i, 0.07 * i, 0.5, -0.03 * i;
    poses.push_back({1000.0 + i / 30.0, Se3::exp(tangent)});
  }
  write_trajectory(path_, poses);
  const std::string first = content();
  const Trajectory read = read_trajectory(path_);
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Se3 change = poses[i].world_from_camera.inverse() * read[i].world_from_camera;
    EXPECT_NEAR(read[i].timestamp, poses[i].timestamp, 6e-7);
    EXPECT_LT(change.translation.norm(), 1e-7);
    EXPECT_LT(change.angle(), 3e-9);
  }
  for (StampedPose& pose : poses) pose.world_from_camera.rotation.coeffs() *= -1.0;
  write_trajectory(path_, poses);
  EXPECT_EQ(content(), first) << "q and -q are one rotation";
}

TEST_F(TrajectoryFile, SortsAndTakesTheLastLineOfEachStamp) {
  write("3 3 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n1 9 0 0 0 0 0 1\n");
  const Trajectory poses = read_trajectory(path_);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_DOUBLE_EQ(poses[0].world_from_camera.translation.x(), 9.0);
  EXPECT_DOUBLE_EQ(poses[1].timestamp, 2.0);
  EXPECT_DOUBLE_EQ(poses[2].timestamp, 3.0);
}

TEST_F(TrajectoryFile, NamesFileLineAndFieldOfWhatIsWrong) {
  const std::string good = "# t\n1 0 0 0 0 0 0 1\n";
  EXPECT_THAT(error_of(good + "2 0 nan 0 0 0 0 1\n"),
              AllOf(HasSubstr(path_.string() + ":3"), HasSubstr("ty"), HasSubstr("remove")));
  EXPECT_THAT(error_of(good + "2 0 0 0 0 0 0 inf\n"), AllOf(HasSubstr(":3"), HasSubstr("qw")));
  EXPECT_THAT(error_of(good + "\n2 0 0\n"), AllOf(HasSubstr(":4"), HasSubstr("3 fields")));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1 7\n"), AllOf(HasSubstr(":1"), HasSubstr("9 fields")));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 0\n"), AllOf(HasSubstr(":1"), HasSubstr("quaternion")));
  EXPECT_THAT(error_of("1 0 0 0 9e160 0 0 1\n"), AllOf(HasSubstr(":1"), HasSubstr("quaternion")));
  EXPECT_THAT(error_of("1 0 0 1e160 0 0 0 1\n"), AllOf(HasSubstr(":1"), HasSubstr("1e+160 m")));
  EXPECT_THAT(error_of("1 0 0x 0 0 0 0 1\n"), AllOf(HasSubstr("ty"), HasSubstr("'0x'")));
  EXPECT_THAT(error_of("a\tb\x01 0 0 0 0 0 0\n"), HasSubstr("'a'"));
}

TEST_F(TrajectoryFile, EmptyMissingAndFolderAreErrors) {
  EXPECT_THAT(error_of(""), HasSubstr("no pose"));
  EXPECT_THAT(error_of("# only a comment\n"), HasSubstr("no pose"));
  fs::remove(path_);
  EXPECT_THROW(read_trajectory(path_), Error);
  EXPECT_THROW(read_trajectory(::testing::TempDir()), Error);
}

TEST_F(TrajectoryFile, APoseThatIsNotFiniteLeavesTheOldFile) {
  Trajectory poses(1);
  write_trajectory(path_, poses);
  const std::string before = content();
  poses[0].world_from_camera.translation.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_trajectory(path_, poses), Error);
  EXPECT_EQ(content(), before);
}

}  // namespace
}  // namespace dkp_slam

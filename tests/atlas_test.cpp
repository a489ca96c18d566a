// Several maps: lost for too long, the camera begins another one, and the two join where they meet.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/synth/source.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

/// A camera in an empty office that turns by 150 degrees, in small pictures. Each frame with its
/// true pose.
struct Turn {
  static constexpr int length = 100;
  Camera camera;
  std::vector<RgbdFrame> frames;
  std::vector<Se3> world_from_camera;

  Turn() {
    const fs::path file = fs::path(::testing::TempDir()) / "dkp_slam_atlas_turn.txt";
    write_trajectory(file, path());
    SyntheticOptions options = synthetic_scenario("static_room");
    options.frames = length;
    options.trajectory = file;
    options.camera.width = 320;
    options.camera.height = 240;
    for (double* focal : {&options.camera.fx, &options.camera.fy}) *focal *= 0.5;
    options.camera.cx = 159.5;
    options.camera.cy = 119.5;
    camera = options.camera;
    SyntheticSource world(options);
    while (auto frame = world.read()) {
      world_from_camera.push_back(world.truth().world_from_camera);
      frames.push_back(std::move(*frame));
    }
    fs::remove(file);
  }

 private:
  static Trajectory path() {
    Trajectory poses;
    for (int i = 0; i <= length; ++i) {
      const double angle = (75.0 - 150.0 * i / length) * M_PI / 180.0;
      const Eigen::Vector3d forward(std::cos(angle), std::sin(angle), 0.0);
      Eigen::Matrix3d axes;  // right, down, forward in a world whose z points up
      axes << forward.y(), 0.0, forward.x(), -forward.x(), 0.0, forward.y(), 0.0, -1.0, 0.0;
      poses.push_back({i / 30.0, Se3(Eigen::Quaterniond(axes), 0.2 * forward)});
    }
    return poses;
  }
};

/// Metres that a path may be off: small pictures with a Kinect's noise give 2 to 6 mm.
constexpr double bound = 0.010;

/// What came of playing frames in some order.
struct Outcome {
  std::vector<char> localised;
  Trajectory truth;  ///< of all frames, in the time they were played in
  std::vector<Trajectory> paths;
  int maps = 0, landmarks = 0;
  std::vector<ClosedLoop> loops;

  double error(std::size_t path) const {
    return absolute_error(truth, paths.at(path)).statistics.rmse;
  }
};

class Atlas : public ::testing::Test {
 protected:
  static const Turn& turn() {
    static const Turn once;
    return once;
  }
  /// Plays these frames of the turn; -1 is a second in which the lens is covered.
  static Outcome play(const std::vector<int>& order) {
    SlamConfig options;
    options.camera = turn().camera;
    options.dynamics.mode = DynamicsMode::off;
    Slam slam(options);
    Outcome outcome;
    double time = 0.0;
    int index = 0;
    for (const int i : order) {
      time += i < 0 ? 1.0 : 1.0 / 30.0;
      if (i < 0) continue;
      RgbdFrame frame = turn().frames.at(std::size_t(i));
      frame.index = index++;
      frame.timestamp = time;
      slam.feed(std::move(frame));
      outcome.localised.push_back(slam.wait()->localised);
      outcome.truth.push_back({time, turn().world_from_camera.at(std::size_t(i))});
    }
    slam.finish();
    outcome.paths = slam.trajectories();
    for (int m = 0; m < slam.map().maps(); ++m) outcome.maps += slam.map().live_keyframes_in(m) > 0;
    outcome.landmarks = slam.map().live_landmarks();
    outcome.loops = slam.loops();
    return outcome;
  }
  static std::vector<int> frames(int from, int to) {
    std::vector<int> order;
    for (int i = from; i != to; i += from < to ? 1 : -1) order.push_back(i);
    return order;
  }
  static std::vector<int> in_turn(const std::vector<std::vector<int>>& parts) {
    std::vector<int> order;
    for (const auto& p : parts) order.insert(order.end(), p.begin(), p.end());
    return order;
  }
};

TEST_F(Atlas, CutInTwoWithAGapTheMapsBecomeOneWhereTheyMeet) {
  // The start; then, 3 s later, the other end of the turn and all the way back.
  const Outcome outcome = play(in_turn({frames(0, 20), {-1, -1, -1}, frames(99, -1)}));
  EXPECT_EQ(outcome.maps, 1);
  ASSERT_EQ(outcome.paths.size(), 1U);
  ASSERT_FALSE(outcome.loops.empty());
  EXPECT_TRUE(outcome.loops.front().joined_maps);
  // Lost only for the second that it takes until another map is begun.
  const auto localised = std::count(outcome.localised.begin(), outcome.localised.end(), 1);
  EXPECT_GE(localised, 120 - 32);
  EXPECT_EQ(outcome.paths.front().size(), std::size_t(localised));
  EXPECT_LT(outcome.error(0), bound);
}

TEST_F(Atlas, MapsThatDoNotMeetStayTwo) {
  const Outcome outcome = play(in_turn({frames(0, 20), {-1, -1}, frames(99, 55)}));
  EXPECT_EQ(outcome.maps, 2);
  ASSERT_EQ(outcome.paths.size(), 2U);
  EXPECT_TRUE(outcome.loops.empty());
  EXPECT_EQ(outcome.paths[0].size() + outcome.paths[1].size(),
            std::size_t(std::count(outcome.localised.begin(), outcome.localised.end(), 1)));
  EXPECT_EQ(outcome.paths[0].size(), 20U);
  EXPECT_LT(outcome.error(0), bound);
  EXPECT_LT(outcome.error(1), bound);
}

TEST_F(Atlas, BackInTheFirstMapTheSecondOneIsKept) {
  // A look at the first place is no way from one to the other: the camera only changes maps.
  const Outcome outcome =
      play(in_turn({frames(0, 20), {-1, -1}, frames(99, 55), {-1, -1}, frames(0, 20)}));
  EXPECT_EQ(outcome.maps, 2);
  ASSERT_EQ(outcome.paths.size(), 2U);
  EXPECT_EQ(outcome.paths[0].size(), 40U);  // the first map has them all, before and after
  EXPECT_LT(outcome.error(0), bound);
}

TEST_F(Atlas, RepeatsExactly) {
  const std::vector<int> order = in_turn({frames(0, 20), {-1, -1, -1}, frames(99, -1)});
  const Outcome first = play(order), second = play(order);
  ASSERT_EQ(first.paths.size(), second.paths.size());
  for (std::size_t i = 0; i < first.paths[0].size(); ++i) {
    EXPECT_EQ(first.paths[0][i].world_from_camera.translation,
              second.paths[0][i].world_from_camera.translation);
  }
}

}  // namespace
}  // namespace dkp_slam

#include "apps/live_path.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using apps::LivePath;
using dkp_slam::testing::content;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class LivePathTest : public testing::CommandTest {
 protected:
  fs::path file() const { return folder_ / "trajectory.live.txt"; }
  fs::path second() const { return folder_ / "trajectory_2.live.txt"; }

  static double stamp(int i) { return 10.0 + i / 30.0; }
  /// Frame `i`, `i` metres along x.
  static void tell(LivePath& path, int i, int map = 0, bool localised = true) {
    auto snapshot = std::make_shared<FrameSnapshot>();
    snapshot->result.index = i;
    snapshot->result.timestamp = stamp(i);
    snapshot->result.localised = localised;
    snapshot->result.world_from_camera.translation.x() = i;
    snapshot->result.map = map;
    path.on_frame(snapshot);
  }
};

TEST_F(LivePathTest, EveryPoseIsInTheFileAtOnce) {
  LivePath path(folder_);
  EXPECT_FALSE(fs::exists(file()));
  for (int i = 0; i < 5; ++i) {
    tell(path, i, 0, i != 3);
    const Trajectory so_far = read_trajectory(file());
    ASSERT_EQ(so_far.size(), i < 3 ? std::size_t(i) + 1 : std::size_t(i));
    const int last = i == 3 ? 2 : i;  // the fourth frame was lost
    EXPECT_NEAR(so_far.back().timestamp, stamp(last), 1e-6);
    EXPECT_NEAR(so_far.back().world_from_camera.translation.x(), last, 1e-6);
  }
  EXPECT_THAT(content(file()), HasSubstr("provisional"));
  path.remove();
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(LivePathTest, NoLineLiesAcrossThePagesOfAWrite) {
  LivePath path(folder_);
  constexpr int count = 1000;
  for (int i = 0; i < count; ++i) tell(path, i * (i % 7 == 0 ? 1000 : 1));
  const std::string text = content(file());
  ASSERT_GT(text.size(), 20U * 4096U);
  std::size_t begin = 0, poses = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    EXPECT_EQ(begin / 4096, end / 4096) << text.substr(begin, end - begin);
    poses += text[begin] != '#';
    begin = end + 1;
  }
  EXPECT_EQ(begin, text.size());
  EXPECT_EQ(poses, std::size_t(count));
}

TEST_F(LivePathTest, AnotherMapHasAnotherWorldAndAFileOfItsOwn) {
  LivePath path(folder_);
  for (int i = 0; i < 10; ++i) tell(path, i, i < 4 ? 7 : 3);
  tell(path, 10, 7);
  EXPECT_EQ(read_trajectory(file()).size(), 5U);
  EXPECT_EQ(read_trajectory(second()).size(), 6U);
  const LivePath next(folder_);  // another run into the same folder
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(LivePathTest, AFullDiskLeavesWholeLinesAndIsGotOver) {
  LivePath path(folder_);
  for (int i = 0; i < 100; ++i) tell(path, i);
  const std::size_t before = content(file()).size();
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit usual{};
  ::getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit full{before + 1000, usual.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  for (int i = 100; i < 200; ++i) tell(path, i);
  ::setrlimit(RLIMIT_FSIZE, &usual);
  EXPECT_GT(content(file()).size(), before);
  EXPECT_LE(content(file()).size(), before + 1000);
  EXPECT_THAT(content(file()), EndsWith("\n"));
  const std::size_t written = read_trajectory(file()).size();
  EXPECT_LT(written, 120U);
  for (int i = 200; i < 300; ++i) tell(path, i);
  EXPECT_EQ(read_trajectory(file()).size(), written + 100);
}

TEST_F(LivePathTest, WhereItCannotBeMadeNothingIsThrown) {
  LivePath path(folder_ / "none");
  for (int i = 0; i < 3; ++i) tell(path, i);
  EXPECT_TRUE(fs::is_empty(folder_));
}

/// Images of the wall in an order of their own: to the right and back, again and again.
class ToAndFro {
 public:
  ToAndFro(const fs::path& folder, int wide, int frames) : wall_(folder, wide) {
    std::string rgb, depth;
    Trajectory path;
    for (int i = 0; i < frames; ++i) {
      const int turn = i % (2 * wide - 2);
      const int place = turn < wide ? turn : 2 * wide - 2 - turn;
      const std::string now = WallSequence::stamp(i), image = WallSequence::stamp(place);
      rgb += fmt::format("{} rgb/{}.png\n", now, image);
      depth += fmt::format("{} depth/{}.png\n", now, image);
      StampedPose pose{std::stod(now), {}};
      pose.world_from_camera.translation.x() =
          WallSequence::step * place * WallSequence::depth / wall_.camera.fx;
      path.push_back(pose);
    }
    std::ofstream(folder / "rgb.txt") << rgb;
    std::ofstream(folder / "depth.txt") << depth;
    write_trajectory(folder / "groundtruth.txt", path);
  }

 private:
  WallSequence wall_;
};

/// Of the frames that the program has said it is done with, the last.
int frames_done(const Program& program) {
  const std::string said = program.err();
  const std::size_t at = said.rfind("run: ");
  return at == std::string::npos ? 0 : std::atoi(said.c_str() + at + 5);
}

TEST_F(LivePathTest, AKilledRunLeavesItsPath) {
  const fs::path sequence = folder_ / "sequence", out = folder_ / "out";
  // So long that the end surely comes in the middle; it says each tenth that is done.
  const ToAndFro wall(sequence, 30, 1000);
  const Program run = start({"run", sequence, "--mode", "off", "--detector", "none", "--out", out});
  for (int i = 0; i < 3000 && frames_done(run) < 100; ++i) std::this_thread::sleep_for(20ms);
  run.kill();
  ASSERT_EQ(run.wait(), 1000 + SIGKILL) << run.err();
  const int done = frames_done(run);
  ASSERT_GE(done, 100);

  const fs::path live = out / "trajectory.live.txt";
  EXPECT_FALSE(fs::exists(out / "trajectory.txt"));
  const std::string text = content(live);
  EXPECT_THAT(text, EndsWith("\n"));
  const Trajectory path = read_trajectory(live);  // throws on a line that is not whole
  const int last = static_cast<int>(std::lround((path.back().timestamp - stamp(0)) * 30.0));
  EXPECT_GE(last, done - 60);                     // two seconds
  EXPECT_GE(path.size(), std::size_t(last) / 2);  // a busy disk may cost some, not most
  const Trajectory truth = read_trajectory(sequence / "groundtruth.txt");
  EXPECT_LT(absolute_error(truth, path).statistics.rmse, 0.004);

  const Program eval = start({"eval", sequence / "groundtruth.txt", live});
  EXPECT_EQ(eval.wait(), 0) << eval.err();
}

}  // namespace
}  // namespace dkp_slam

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/test_command.h"
#include "apps/test_sequence.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::WallSequence;

class CalibrateCommand : public testing::CommandTest {
 protected:
  int run(const std::vector<std::string>& arguments) { return call({"calibrate"}, arguments); }
  std::string path(const std::string& name) const { return folder_ / name; }
};

/// It glides along a wall evenly: every row sees the same, only later.
TEST_F(CalibrateCommand, RefusesAMotionThatTellsNothing) {
  const WallSequence wall(path("wall"), 60);
  EXPECT_EQ(run({path("wall"), "--out", path("found.yaml")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("too even"));
  EXPECT_FALSE(fs::exists(path("found.yaml")));
}

TEST_F(CalibrateCommand, RefusesACameraThatStandsStill) {
  const WallSequence wall(path("wall"), 1);
  std::ofstream rgb(path("wall/rgb.txt")), depth(path("wall/depth.txt"));
  for (int i = 0; i < 60; ++i) {
    rgb << WallSequence::stamp(i) << " rgb/" << WallSequence::stamp(0) << ".png\n";
    depth << WallSequence::stamp(i) << " depth/" << WallSequence::stamp(0) << ".png\n";
  }
  rgb.close();
  depth.close();
  EXPECT_EQ(run({path("wall"), "--out", path("found.yaml")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("hardly moves"));
  EXPECT_FALSE(fs::exists(path("found.yaml")));
}

TEST_F(CalibrateCommand, RefusesWhatIsTooShort) {
  const WallSequence wall(path("wall"), 5);
  EXPECT_EQ(run({path("wall"), "--out", path("found.yaml")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("too little was seen"));
}

TEST_F(CalibrateCommand, SaysWhatIsWrongOnTheCommandLine) {
  const WallSequence wall(path("wall"), 1);
  const std::string out = path("found.yaml");
  EXPECT_EQ(run({path("wall")}), 2);
  EXPECT_THAT(stderr_, HasSubstr("--out is required"));
  EXPECT_EQ(run({path("wall"), "--out", out, "--plot", "a.gif"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("must end in .svg or .png"));
  EXPECT_EQ(run({path("wall"), "--out", out, "--length", "1,2,3"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("must be six numbers"));
  EXPECT_EQ(run({path("wall"), "--out", out, "--length", "1,2,3,4,x,6"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("\"x\" is no number"));
  EXPECT_EQ(run({path("none"), "--out", out}), 1);
  EXPECT_THAT(stderr_, HasSubstr("no such folder"));
  EXPECT_EQ(run({path("wall"), "--out", path("none/found.yaml")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("none"));
}

}  // namespace
}  // namespace dkp_slam

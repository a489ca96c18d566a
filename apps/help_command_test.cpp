#include <cstdio>
#include <filesystem>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/test_command.h"
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/sensor/bag/bag_source.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

class HelpCommand : public testing::CommandTest {
 protected:
  /// What completion offers a user of bash who has typed these words and presses the tab key.
  std::vector<std::string> offered(const std::vector<std::string>& words) {
    EXPECT_EQ(call({"completion", "bash"}), 0) << stderr_;
    const fs::path script = folder_ / "dkp-slam.bash";
    fs::copy_file(folder_ / "stdout.log", script, fs::copy_options::overwrite_existing);
    std::string line = "source '" + script.string() + "'; COMP_WORDS=(dkp-slam";
    for (const std::string& word : words) line += " '" + word + "'";
    line += "); COMP_CWORD=" + std::to_string(words.size());
    line += "; _dkp_slam; printf '%s\\n' \"${COMPREPLY[@]}\"";
    const fs::path file = folder_ / "complete.bash";
    std::ofstream(file) << line;
    EXPECT_EQ(std::system(("bash '" + file.string() + "' > '" + file.string() + ".out'").c_str()),
              0);
    std::istringstream lines(content(file.string() + ".out"));
    std::vector<std::string> out;
    for (std::string word; std::getline(lines, word);) out.push_back(word);
    return out;
  }
  std::set<std::string> commands() {
    EXPECT_EQ(call({"help"}), 0) << stderr_;
    std::set<std::string> found;
    const std::string text = stdout_.substr(stdout_.find("Commands"));
    const std::regex command("  dkp-slam ([a-z]+) ");
    for (std::sregex_iterator m(text.begin(), text.end(), command), end; m != end; ++m) {
      found.insert((*m)[1]);
    }
    return found;
  }
};

TEST_F(HelpCommand, ListsPagesAndCommandsAndPrintsEach) {
  EXPECT_THAT(commands(), IsSupersetOf({"run", "map", "doctor", "help", "export"}));
  for (const char* page : {"first-run", "own-camera", "robot", "benchmark", "python", "cpp"}) {
    ASSERT_EQ(call({"help", page}), 0) << stderr_;
    EXPECT_EQ(stdout_, content(fs::path(DKP_SLAM_DOCS) / "help" / (std::string(page) + ".md")));
  }
  ASSERT_EQ(call({"help", "eval"}), 0);
  EXPECT_THAT(stdout_, HasSubstr("--plot"));
  EXPECT_EQ(call({"help", "nosuch"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("no page 'nosuch'; there are first-run"));
}

TEST_F(HelpCommand, WhatThePagesTellToTypeExists) {
  const std::set<std::string> known = commands();
  const std::regex command("dkp-slam ([a-z]+)([^`\\n]*)"), option("--[a-z-]+");
  int checked = 0;
  for (const auto& page : fs::directory_iterator(fs::path(DKP_SLAM_DOCS) / "help")) {
    const std::string text = content(page.path());
    for (std::sregex_iterator m(text.begin(), text.end(), command), end; m != end; ++m) {
      const std::string name = (*m)[1], rest = (*m)[2];
      ASSERT_THAT(known, Contains(name)) << page.path() << ": " << m->str();
      ASSERT_EQ(call({name, "--help"}), 0);
      for (std::sregex_iterator o(rest.begin(), rest.end(), option); o != end; ++o, ++checked) {
        EXPECT_THAT(stdout_, HasSubstr(o->str())) << page.path() << ": " << m->str();
      }
    }
  }
  EXPECT_GT(checked, 15);
}

TEST_F(HelpCommand, BashCompletesCommandsOptionsAndValues) {
  EXPECT_THAT(offered({"ru"}), ElementsAre("run"));
  EXPECT_THAT(offered({"map", "m"}), ElementsAre("merge"));
  EXPECT_THAT(offered({"run", "--mode", "d"}), ElementsAre("d", "dk", "dkp", "dkp+"));
  EXPECT_THAT(offered({"run", "--det"}), ElementsAre("--detections", "--detector"));
  // A flag takes no value: after it comes the next argument.
  EXPECT_THAT(offered({"run", "--overlay", "--out"}), ElementsAre("--out"));
  EXPECT_EQ(call({"completion", "fish"}), 2);
}

TEST_F(HelpCommand, ZshGetsEveryCommandWithItsMeaning) {
  const std::set<std::string> known = commands();
  ASSERT_EQ(call({"completion", "zsh"}), 0);
  EXPECT_THAT(stdout_, HasSubstr("#compdef dkp-slam"));
  for (const std::string& name : known) EXPECT_THAT(stdout_, HasSubstr('\'' + name + ':'));
  // In zsh `path` is the shell's own list of folders.
  EXPECT_THAT(stdout_, Not(HasSubstr("local path")));
}

TEST_F(HelpCommand, TheManualPageHasEveryOption) {
  ASSERT_EQ(call({"run", "--help"}), 0);
  const std::string run = stdout_;
  ASSERT_EQ(call({"man"}), 0);
  std::string page = std::regex_replace(stdout_, std::regex("\\\\-"), "-");
  EXPECT_THAT(page, HasSubstr(".TH DKP-SLAM 1"));
  const std::regex option("\\n  (?:-[a-z],)?(--[a-z-]+)");
  int options = 0;
  for (std::sregex_iterator m(run.begin(), run.end(), option), end; m != end; ++m, ++options) {
    EXPECT_THAT(page, HasSubstr((*m)[1].str()));
  }
  EXPECT_GT(options, 20);
}

TEST_F(HelpCommand, TheDoctorTellsWhatIsMissingAndWhatMendsIt) {
  ASSERT_EQ(call({"doctor"}), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("ok processor"));
  // What was found when it was configured, and of what was not how to get it.
  if (can_read_kinects() && can_read_bags() && has_octomap()) {
    EXPECT_THAT(stdout_, HasSubstr("ok parts      Kinect, bags, OctoMap\n"));
  } else {
    EXPECT_THAT(stdout_, HasSubstr("-- parts      "));
    EXPECT_THAT(stdout_, HasSubstr("-> only who needs them: scripts/setup.sh --with "));
  }
  EXPECT_THAT(stdout_, HasSubstr("-- detector   no YOLOX weights"));
  EXPECT_THAT(stdout_, HasSubstr("-> scripts/fetch_model.sh"));
  EXPECT_THAT(stdout_, HasSubstr("images a second"));
  environment_ = {"DKP_SLAM_MODEL=/nosuch.onnx"};
  EXPECT_EQ(call({"doctor"}), 1);
  EXPECT_THAT(stdout_,
              HasSubstr("!! detector   no model file '/nosuch.onnx' (from DKP_SLAM_MODEL)"));
  EXPECT_THAT(stderr_, HasSubstr("marked !!"));
}

TEST_F(HelpCommand, TheDoctorNamesTheDetectorThatRuns) {
  const char* model = std::getenv("DKP_SLAM_MODEL");
  if (model == nullptr || *model == '\0') GTEST_SKIP() << "DKP_SLAM_MODEL names no weights";
  environment_ = {std::string("DKP_SLAM_MODEL=") + model};
  ASSERT_EQ(call({"doctor"}), 0) << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("ok detector   yolox ("));
  EXPECT_THAT(stdout_, HasSubstr("ms an image"));
}

}  // namespace
}  // namespace dkp_slam

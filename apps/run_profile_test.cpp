#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "apps/test_sequence.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

/// What `run` tells of its own speed.
class RunProfile : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
  }

  int run(const std::string& out, const std::vector<std::string>& more) {
    return call({"run", sequence_->folder(), "--camera", sequence_->folder() / "camera.yaml",
                 "--detector", "motion", "--out", folder_ / out},
                more);
  }
  nlohmann::json json(const std::string& file) const {
    return nlohmann::json::parse(std::ifstream(folder_ / file));
  }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(RunProfile, ATraceHasTheStagesOfEveryFrameByThread) {
  const std::string file = folder_ / "trace.json";
  ASSERT_EQ(run("out", {"--profile", file}), 0) << stderr_;
  std::map<int, std::string> threads;
  std::map<std::string, std::set<int>> frames;
  std::set<std::string> names;
  for (const nlohmann::json& e : json("trace.json")) {
    if (e["name"] == "thread_name") threads[e["tid"]] = e["args"]["name"];
  }
  for (const nlohmann::json& e : json("trace.json")) {
    if (e["ph"] != "X") continue;
    names.insert(threads.at(e["tid"]) + ": " + e["name"].get<std::string>());
    if (e.contains("args")) frames[e["name"]].insert(e["args"]["frame"].get<int>());
  }
  EXPECT_THAT(names,
              IsSupersetOf({"main: read", "features: features", "detector: detection",
                            "tracking: frame", "tracking: flow", "tracking: masks",
                            "tracking: removal", "tracking: localise", "tracking: keyframe"}));
  for (const char* stage : {"features", "detection", "frame"}) {
    EXPECT_EQ(frames[stage].size(), frame_count) << stage;
  }
}

TEST_F(RunProfile, ATraceThatCannotBeWrittenEndsTheRunBeforeItBegins) {
  EXPECT_EQ(run("out", {"--profile", "/no/such/folder/trace.json"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("/no/such/folder/trace.json"));
}

TEST_F(RunProfile, PreloadedImagesGiveTheSamePath) {
  ASSERT_EQ(run("out", {}), 0) << stderr_;
  ASSERT_EQ(run("preloaded", {"--preload"}), 0) << stderr_;
  EXPECT_EQ(content(folder_ / "out/trajectory.txt"), content(folder_ / "preloaded/trajectory.txt"));
  EXPECT_EQ(content(folder_ / "out/detections.txt"), content(folder_ / "preloaded/detections.txt"));
  const nlohmann::json read = json("out/summary.json"), preloaded = json("preloaded/summary.json");
  EXPECT_GT(read["processor_ms_per_frame"], 0.0);
  EXPECT_GT(preloaded["processor_ms_per_frame"], 0.0);
  EXPECT_GT(read["median_ms"]["decode"], preloaded["median_ms"]["decode"]);
  EXPECT_GT(read["median_ms"]["latency"], read["median_ms"]["tracking"]);
  EXPECT_EQ(run("view", {"--preload", "--view"}), 2);
  EXPECT_EQ(call({"run", "-", "--preload", "--out", folder_ / "stream"}), 2);
}

}  // namespace
}  // namespace dkp_slam

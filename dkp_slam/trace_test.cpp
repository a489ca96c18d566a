#include "dkp_slam/trace.h"

#include <fstream>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

class Trace : public testing::Test {
 protected:
  nlohmann::json events() const { return nlohmann::json::parse(std::ifstream(file_)); }

  fs::path file_ =
      fs::path(testing::TempDir()) /
      (testing::UnitTest::GetInstance()->current_test_info()->name() + std::string(".trace.json"));
};

TEST_F(Trace, HoldsTheSpansOfAllThreads) {
  { const TraceSpan before("before"); }
  TraceRecording recording(file_);
  {
    const TraceSpan outer("outer", 7);
    const TraceSpan inner("inner");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::thread([] {
    name_thread("worker of a long name");
    const TraceSpan other("other");
  }).join();
  recording.finish();
  { const TraceSpan after("after"); }

  std::map<std::string, nlohmann::json> spans;
  std::map<int, std::string> threads;
  for (const nlohmann::json& e : events()) {
    if (e["ph"] == "X") spans[e["name"]] = e;
    if (e["name"] == "thread_name") threads[e["tid"]] = e["args"]["name"];
  }
  ASSERT_EQ(spans.size(), 3U);
  const auto &outer = spans.at("outer"), &inner = spans.at("inner"), &other = spans.at("other");
  EXPECT_EQ(outer["args"]["frame"], 7);
  EXPECT_FALSE(inner.contains("args"));
  EXPECT_LE(outer["ts"].get<double>(), inner["ts"].get<double>());
  EXPECT_GE(outer["dur"].get<double>(), inner["dur"].get<double>());
  EXPECT_GE(inner["dur"].get<double>(), 2000.0);
  EXPECT_EQ(threads.at(outer["tid"]), "main");
  EXPECT_EQ(threads.at(other["tid"]), "worker of a long name");
}

TEST_F(Trace, NeedsAFileAndOneAtATime) {
  EXPECT_THROW(TraceRecording(fs::path("/no/such/folder/trace.json")), Error);
  TraceRecording first(file_);
  EXPECT_THROW(TraceRecording{file_}, Error);
  first.finish();
  TraceRecording(file_).finish();
  EXPECT_EQ(events().size(), 1U);
}

}  // namespace
}  // namespace dkp_slam

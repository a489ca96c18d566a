#include "apps/run_summary.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

json good() {
  return json::parse(R"({
    "options": {"sequence": "room", "topics": "/c,/d", "camera": "fr1", "model": "a.onnx",
                "frame_rate": 30.0},
    "detector": "motion", "frames": 12, "skipped_frames": 1, "features": 1000,
    "features_removed": 30, "keyframes": 3, "landmarks": 400, "loops_closed": 1,
    "maps": [12, 4], "maps_joined": 2, "median_ms": {"frame": 12.5, "tracking": 3},
    "peak_memory_mb": 160.5})");
}

std::string refusal_of(const std::string& text) {
  try {
    parse_run_summary(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "taken";
}

TEST(RunSummary, SaysWhatTheRunSaid) {
  const RunSummary run = parse_run_summary(good().dump());
  EXPECT_EQ(run.input.sequence, "room");
  EXPECT_EQ(run.input.topics, "/c,/d");
  EXPECT_EQ(run.input.camera, "fr1");
  EXPECT_EQ(run.input.model, "a.onnx");
  EXPECT_EQ(run.input.frame_rate, 30.0);
  EXPECT_EQ(run.detector, "motion");
  EXPECT_EQ(run.frames, 12U);
  EXPECT_EQ(run.skipped_frames, 1U);
  EXPECT_EQ(run.features, 1000U);
  EXPECT_EQ(run.features_removed, 30U);
  EXPECT_EQ(run.keyframes, 3U);
  EXPECT_EQ(run.landmarks, 400U);
  EXPECT_EQ(run.loops_closed, 1U);
  EXPECT_EQ(run.maps, 2U);
  EXPECT_EQ(run.maps_joined, 2U);
  EXPECT_EQ(run.peak_memory_mb, 160.5);
  EXPECT_EQ(run.median_ms.at("frame"), 12.5);
  EXPECT_EQ(run.median_ms.at("tracking"), 3.0);
}

TEST(RunSummary, CountsThatAreNone) {
  for (const json& value : {json(-1), json(1e300), json("12"), json(), json(1.5),
                            json(18'000'000'000'000'000'000U), json::array({1})}) {
    json summary = good();
    summary["frames"] = value;
    EXPECT_EQ(refusal_of(summary.dump()), "frames is no count") << value;
  }
  json summary = good();
  summary["median_ms"]["frame"] = "fast";
  EXPECT_EQ(refusal_of(summary.dump()), "frame is no number");
  summary["median_ms"] = 12;
  EXPECT_EQ(refusal_of(summary.dump()), "median_ms is no JSON object");
  EXPECT_EQ(refusal_of("[]"), "is no JSON object");
  EXPECT_EQ(refusal_of("{"), "is no JSON object");
}

TEST(RunSummary, OfTheInputItTakesWhatThereIs) {
  for (const char* text : {"", "[1]", "{}", R"({"options": 3})",
                           R"({"options": {"sequence": 3, "frame_rate": "30"}})"}) {
    const RunInput input = parse_run_input(text);
    EXPECT_EQ(input.sequence, "") << text;
    EXPECT_FALSE(input.frame_rate) << text;
  }
  EXPECT_EQ(parse_run_input(R"({"options": {"sequence": "room"}})").sequence, "room");
}

TEST(RunSummary, OfAFolder) {
  const fs::path folder = fs::path(::testing::TempDir()) / "run_summary_test";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto refused = [&](const std::string& why) {
    try {
      read_run_summary(folder);
      ADD_FAILURE() << "taken";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr((folder / "summary.json").string() + ": " + why));
      EXPECT_THAT(error.what(), HasSubstr("; run it again"));
    }
  };
  refused("cannot be read: No such file");
  EXPECT_EQ(read_run_input(folder).sequence, "");
  std::ofstream(folder / "summary.json") << "{}";
  refused("frames is no count");
  std::ofstream(folder / "summary.json") << good();
  EXPECT_EQ(read_run_summary(folder).frames, 12U);
  EXPECT_EQ(read_run_input(folder).camera, "fr1");
  fs::remove(folder / "summary.json");
  fs::create_directory(folder / "summary.json");  // opening it would not fail
  refused("cannot be read: it is a folder");
  EXPECT_EQ(read_run_input(folder).sequence, "");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace dkp_slam::apps

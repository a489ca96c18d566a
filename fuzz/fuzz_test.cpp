// Every fuzz target on its own inputs and on mutations of them, without a fuzzer: what holds here
// holds in the release build, too. scripts/fuzz.sh looks further.
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

/// Some bytes are others, a piece is left out, doubled or taken from another input.
std::string mutated(std::string text, const std::string& other, std::mt19937& random) {
  const auto below = [&random](std::size_t bound) { return bound == 0 ? 0 : random() % bound; };
  for (std::size_t changes = 1 + below(6); changes > 0; --changes) {
    const std::size_t at = below(text.size() + 1), length = 1 + below(8);
    switch (below(5)) {
      case 0:
        text.erase(std::min(at, text.size()), length);
        break;
      case 1:
        text.insert(at, text.substr(below(text.size() + 1), length));
        break;
      case 2:
        text.insert(at, other.substr(below(other.size() + 1), 4 * length));
        break;
      default:
        if (at < text.size())
          text[at] = static_cast<char>(below(3) == 0 ? random() : text[at] ^ (1 << below(8)));
    }
  }
  return text;
}

/// What a fuzzer found once (scripts/fuzz.sh).
std::vector<std::string> found_once(const std::string& target) {
  const std::filesystem::path folder = std::filesystem::path(DKP_SLAM_FOUND_FOLDER) / target;
  std::vector<std::string> inputs;
  if (!std::filesystem::exists(folder)) return inputs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return inputs;
}

TEST(FuzzTargets, HoldOnTheirSeedsOnWhatWasFoundAndOnMutationsOfThem) {
  constexpr int mutations = 400;
  spdlog::set_level(spdlog::level::off);
  ASSERT_GE(targets().size(), 21U);
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    std::vector<std::string> inputs = target.seeds();
    for (std::string& input : found_once(target.name)) inputs.push_back(std::move(input));
    for (const std::string& input : inputs) {
      ASSERT_NO_THROW(target.run(bytes_of(input))) << ::testing::PrintToString(input);
    }
    std::mt19937 random(1);
    for (int i = 0; i < mutations; ++i) {
      const std::string input =
          mutated(inputs[random() % inputs.size()], inputs[random() % inputs.size()], random);
      ASSERT_NO_THROW(target.run(bytes_of(input))) << ::testing::PrintToString(input);
    }
  }
  spdlog::set_level(spdlog::level::info);
}

TEST(FuzzTargets, WhatDoesNotHoldIsAFinding) {
  EXPECT_THROW(require(false, "what must hold"), std::logic_error);
  EXPECT_FALSE(takes([] { throw Error("a line"); }));
  EXPECT_THROW(takes([] { throw Error(""); }), std::logic_error);
  EXPECT_THROW(takes([] { throw std::out_of_range("index"); }), std::out_of_range);
}

}  // namespace
}  // namespace dkp_slam::fuzz

// Detectors that talk nonsense, hang or mean another image: the room is found all the same.

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/recording.h"
#include "tests/support/run.h"

namespace dkp_slam {
namespace {

using testing::Outcome;
using testing::Recording;

class AnyDetector : public Detector {
 public:
  using Answer = std::function<std::vector<Detection>(const RgbdFrame&)>;
  explicit AnyDetector(Answer answer) : answer_(std::move(answer)) {}
  std::string name() const override { return "any"; }
  std::vector<Detection> detect(const RgbdFrame& frame) override { return answer_(frame); }

 private:
  const Answer answer_;
};

const Recording& room() {
  static const Recording recording("static_room", 25);
  return recording;
}

Outcome run_with(AnyDetector::Answer answer) {
  return testing::run(room().play(), std::make_unique<AnyDetector>(std::move(answer)),
                      room().camera, DynamicsMode::dkp_plus);
}

void expect_found(const Outcome& outcome) {
  EXPECT_TRUE(outcome.lost().empty());
  EXPECT_LT(room().error(outcome.path), 0.01);
  EXPECT_EQ(outcome.detector_failures, 0);
}

/// Any bits as numbers, silhouettes of any size and type.
std::vector<Detection> nonsense(std::mt19937& random) {
  const auto any = [&random] {
    const auto bits = static_cast<std::uint32_t>(random());
    float value = 0.0F;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  };
  std::vector<Detection> all(random() % 50);
  for (Detection& d : all) {
    const bool wild = random() % 2 == 0;
    const auto pixels = [&] { return wild ? any() : static_cast<float>(random() % 2000) - 700.0F; };
    d.box = cv::Rect2f(pixels(), pixels(), pixels(), pixels());
    d.class_id = static_cast<int>(random()) % 100;
    d.score = random() % 4 == 0 ? any() : static_cast<float>(random() % 200) / 100.0F;
    d.weight = random() % 4 == 0 ? any() : static_cast<float>(random() % 12);
    const int types[] = {CV_8UC1, CV_8UC3, CV_32FC1, CV_64FC2};
    if (random() % 2 == 0)
      d.mask = cv::Mat::ones(1 + random() % 300, 1 + random() % 300, types[random() % 4]);
  }
  return all;
}

TEST(DetectorFaults, NonsenseEndsNothing) {
  std::mt19937 random(1);
  const Outcome outcome = run_with([&](const RgbdFrame&) { return nonsense(random); });
  EXPECT_EQ(outcome.frames.size(), room().frames.size());
  EXPECT_EQ(outcome.detector_failures, 0);
}

TEST(DetectorFaults, ThousandsOfBoxesEndNothing) {
  const Outcome outcome = run_with([](const RgbdFrame&) {
    Detection d;
    d.box = cv::Rect2f(0.0F, 0.0F, 640.0F, 480.0F);
    d.class_id = 0;
    d.score = 0.01F;
    return std::vector<Detection>(2000, d);
  });
  EXPECT_EQ(outcome.frames.size(), room().frames.size());
}

TEST(DetectorFaults, AnAnswerOfAnotherImageCostsLittle) {
  std::vector<Detection> last;
  expect_found(run_with([&](const RgbdFrame& frame) {
    Detection d;
    d.class_id = 0;
    d.score = 0.9F;
    d.box = cv::Rect2f(static_cast<float>(frame.index % 20) * 20.0F, 100.0F, 120.0F, 300.0F);
    return std::exchange(last, {d});
  }));
}

TEST(DetectorFaults, OneThatHangsHoldsNobodyUpLive) {
  SlamConfig config;
  config.camera = room().camera;
  config.realtime = true;
  constexpr auto hang = std::chrono::milliseconds(600);
  std::atomic<bool> entered = false;
  Slam slam(config, std::make_unique<AnyDetector>([&](const RgbdFrame&) {
              entered = true;
              std::this_thread::sleep_for(hang);
              return std::vector<Detection>();
            }));
  int answered = 0;
  for (int i = 0; i < 10; ++i) {
    slam.feed(room().frames[static_cast<std::size_t>(i)]);
    while (slam.counters().answered + slam.counters().dropped <= i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    while (const auto result = slam.poll()) answered += result->localised;
  }
  EXPECT_TRUE(entered);
  EXPECT_GE(answered, 5);  // while the first answer is not there
  slam.finish();
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/system/slam.h"

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "tests/support/changed_source.h"
#include "tests/support/file_text.h"
#include "tests/support/recording.h"
#include "tests/support/run.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using testing::ChangedSource;
using testing::motion_detector;
using testing::Outcome;
using testing::Recording;
using testing::run;

/// A hand over the lens: no picture, no depth, from one frame to another (exclusive).
ChangedSource::Change cover(int from, int to) {
  return [from, to](RgbdFrame& frame) {
    if (frame.index < from || frame.index >= to) return;
    frame.colour = cv::Mat(frame.colour.size(), CV_8UC3, cv::Scalar::all(8));
    frame.depth = cv::Mat::zeros(frame.depth.size(), CV_32F);
  };
}

/// Detects exactly what is true: each connected piece of the mask, with its silhouette.
class TrueDetector : public Detector {
 public:
  explicit TrueDetector(const std::vector<SyntheticTruth>& truths) : truths_(truths) {}
  std::string name() const override { return "truth"; }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    cv::Mat labels, boxes, centres;
    const cv::Mat& mask = truths_.at(std::size_t(frame.index)).mask;
    const int pieces = cv::connectedComponentsWithStats(mask, labels, boxes, centres);
    std::vector<Detection> found;
    for (int i = 1; i < pieces; ++i) {
      const int* b = boxes.ptr<int>(i);
      if (b[cv::CC_STAT_AREA] < 500) continue;
      const cv::Rect box(b[cv::CC_STAT_LEFT], b[cv::CC_STAT_TOP], b[cv::CC_STAT_WIDTH],
                         b[cv::CC_STAT_HEIGHT]);
      Detection d;
      d.box = box;
      d.class_id = 0;
      d.score = 1.0F;
      d.mask = labels(box) == i;
      found.push_back(d);
    }
    return found;
  }

 private:
  const std::vector<SyntheticTruth>& truths_;
};

TEST(SyntheticSlam, StaticRoom) {
  const Recording room("static_room", 60);
  for (const DynamicsMode mode : {DynamicsMode::off, DynamicsMode::dkp_plus}) {
    const Outcome outcome = run(room.play(), nullptr, room.camera, mode);
    EXPECT_EQ(outcome.lost(), std::vector<int>());
    EXPECT_LT(room.error(outcome.path), 0.006);
    EXPECT_LT(outcome.removed_share(), 0.01);
  }
}

TEST(SyntheticSlam, WalkingPeopleWithTrueDetectionsInEveryMode) {
  const Recording room("walking_xyz", 48, 85);  // somebody walks up to the camera
  for (const DynamicsMode mode :
       {DynamicsMode::d, DynamicsMode::dk, DynamicsMode::dkp, DynamicsMode::dkp_plus}) {
    SCOPED_TRACE(static_cast<int>(mode));
    const Outcome outcome =
        run(room.play(), std::make_unique<TrueDetector>(room.truths), room.camera, mode);
    EXPECT_EQ(outcome.lost(), std::vector<int>());
    EXPECT_LT(room.error(outcome.path), 0.008);
    EXPECT_GT(outcome.removed_share(), 0.05);
  }
}

TEST(SyntheticSlam, GoesOnWithoutADetectorThatFails) {
  class FailingDetector : public TrueDetector {
   public:
    using TrueDetector::TrueDetector;
    std::vector<Detection> detect(const RgbdFrame& frame) override {
      if (frame.index == 12) throw Error("the network is gone");
      return TrueDetector::detect(frame);
    }
  };
  const Recording room("walking_xyz", 40);
  const Outcome outcome = run(room.play(), std::make_unique<FailingDetector>(room.truths),
                              room.camera, DynamicsMode::dkp_plus);
  EXPECT_EQ(outcome.detector_failures, 1);
  EXPECT_EQ(outcome.lost(), std::vector<int>());
  EXPECT_GT(outcome.frames[11].detections, 0);
  for (std::size_t i = 12; i < 40; ++i) EXPECT_EQ(outcome.frames[i].detections, 0);
  EXPECT_LT(room.error(outcome.path), 0.015);
}

TEST(SyntheticSlam, FindsItsPlaceAgainAfterTheLensWasCovered) {
  const Recording room("static_room", 80);
  const Outcome outcome = run(std::make_unique<ChangedSource>(room.play(), cover(30, 60)), nullptr,
                              room.camera, DynamicsMode::dkp_plus);
  std::vector<int> covered(30);
  std::iota(covered.begin(), covered.end(), 30);
  EXPECT_EQ(outcome.lost(), covered);  // and not one frame more
  EXPECT_LT(room.error(outcome.path), 0.010);
}

/// Writes the path and reads the file's bytes.
std::string bytes_of(const Trajectory& path) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const fs::path file = fs::path(::testing::TempDir()) / (std::string(info->name()) + ".txt");
  write_trajectory(file, path);
  std::string bytes = testing::content(file);
  fs::remove(file);
  return bytes;
}

/// Threads that keep every core busy, so that all others meet at other moments.
class Hog {
 public:
  Hog() {
    for (unsigned i = 0; i < std::max(2U, std::thread::hardware_concurrency()); ++i) {
      threads_.emplace_back([this] {
        while (!stop_) {
        }
      });
    }
  }
  ~Hog() {
    stop_ = true;
    for (std::thread& t : threads_) t.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

void expect_repeatable(const std::function<Trajectory()>& run_once) {
  const std::string first = bytes_of(run_once());
  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(bytes_of(run_once()), first);
  const Hog hog;
  EXPECT_EQ(bytes_of(run_once()), first);
}

TEST(SyntheticSlam, RepeatsToTheByteAlsoOnABusyMachine) {
  const Recording room("walking_xyz", 40);
  expect_repeatable([&] {
    return run(room.play(), motion_detector(room.camera), room.camera, DynamicsMode::dkp_plus).path;
  });
}

/// Real sequences under DKP_SLAM_DATA, YOLOX weights by DKP_SLAM_MODEL.
class RealSlam : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("DKP_SLAM_DATA");
    if (!data) GTEST_SKIP() << "DKP_SLAM_DATA names no folder of real sequences";
    data_ = data;
  }
  fs::path truth_of(const std::string& sequence) const {
    return data_ / sequence / "groundtruth.txt";
  }
  static Camera camera_of(const std::string& sequence) {
    const std::string file = sequence.starts_with("fr3") ? "tum_fr3.yaml" : "tum_fr1.yaml";
    return load_camera(std::string(DKP_SLAM_CONFIG_FOLDER "/") + file);
  }
  std::unique_ptr<RgbdSource> open(const std::string& sequence,
                                   std::optional<std::size_t> limit = {}) const {
    TumOptions options;
    options.frame_limit = limit;
    return open_tum_folder(data_ / sequence, camera_of(sequence), options);
  }
  /// dkp+ with YOLOX, all frames localised; the error, metres.
  double error_with_yolox(const std::string& sequence) const {
    const Outcome outcome =
        run(open(sequence), yolox(), camera_of(sequence), DynamicsMode::dkp_plus);
    EXPECT_EQ(outcome.lost(), std::vector<int>());
    return absolute_error(read_trajectory(truth_of(sequence)), outcome.path).statistics.rmse;
  }
  static std::unique_ptr<Detector> yolox() {
    YoloxOptions options;
    options.model = std::getenv("DKP_SLAM_MODEL");
    return make_yolox_detector(options);
  }

  fs::path data_;
};

class RealSlamWithYolox : public RealSlam {
 protected:
  void SetUp() override {
    RealSlam::SetUp();
    if (!std::getenv("DKP_SLAM_MODEL")) GTEST_SKIP() << "DKP_SLAM_MODEL names no YOLOX weights";
  }
};

TEST_F(RealSlam, Freiburg1XyzPlain) {
  const Outcome outcome =
      run(open("fr1_xyz", 250), nullptr, camera_of("fr1_xyz"), DynamicsMode::off);
  EXPECT_EQ(outcome.lost(), std::vector<int>());
  const auto error = absolute_error(read_trajectory(truth_of("fr1_xyz")), outcome.path);
  EXPECT_LE(error.statistics.rmse, 0.0095);
  EXPECT_EQ(outcome.removed_share(), 0.0);
}

TEST_F(RealSlam, FindsItsPlaceAgainAfterTheLensWasCovered) {
  const Outcome outcome =
      run(std::make_unique<ChangedSource>(open("fr1_xyz", 250), cover(120, 150)), nullptr,
          camera_of("fr1_xyz"), DynamicsMode::off);
  const std::vector<int> lost = outcome.lost();
  ASSERT_GE(lost.size(), 30U);
  EXPECT_EQ(lost.front(), 120);
  EXPECT_LT(lost.back(), 165);  // half a second after the hand has gone
  const auto error = absolute_error(read_trajectory(truth_of("fr1_xyz")), outcome.path);
  EXPECT_LE(error.statistics.rmse, 0.0150);
}

TEST_F(RealSlam, Freiburg3WalkingHalfsphereWithTheMotionDetector) {
  const std::string name = "fr3_walking_halfsphere_50";
  const Outcome outcome =
      run(open(name), motion_detector(camera_of(name)), camera_of(name), DynamicsMode::dkp_plus);
  EXPECT_EQ(outcome.lost(), std::vector<int>());
  EXPECT_LE(absolute_error(read_trajectory(truth_of(name)), outcome.path).statistics.rmse, 0.0150);
}

TEST_F(RealSlamWithYolox, Freiburg3WalkingHalfsphere) {
  EXPECT_LE(error_with_yolox("fr3_walking_halfsphere_50"), 0.0130);
}

TEST_F(RealSlamWithYolox, CompositeWalking) {
  EXPECT_LE(error_with_yolox("composite_xyz_walking"), 0.0105);
}

TEST_F(RealSlamWithYolox, CompositeSitting) {
  EXPECT_LE(error_with_yolox("composite_xyz_sitting"), 0.0100);
}

TEST_F(RealSlamWithYolox, RepeatsToTheByteAlsoOnABusyMachine) {
  expect_repeatable([&] {
    return run(open("composite_xyz_walking", 120), yolox(), camera_of("composite_xyz_walking"),
               DynamicsMode::dkp_plus)
        .path;
  });
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/dynamics/dynamics_module.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

cv::Mat texture(const cv::Size& size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat noise(size, CV_8UC1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 2.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise;
}

/// A camera that slides to the right at 0.1 m/s past a wall 3 m off, and somebody 1.5 m off who
/// walks to the right at 0.75 m/s or stands. Exact images, depths and masks.
class World {
 public:
  explicit World(double speed) : speed_(speed) {}

  struct View {
    RgbdFrame frame;
    cv::Mat grey, truth;
    std::vector<cv::KeyPoint> keypoints;
    Detection detection;
  };
  View at(int index) const {
    const double time = index / 30.0;
    View v;
    const double wall_shift = 0.1 * time / 3.0 * 525.0;
    const double body_left = 200.0 + (speed_ - 0.1) * time / 1.5 * 525.0;
    cv::Mat wall, body;
    cv::warpAffine(wall_, wall, cv::Matx23d(1, 0, -wall_shift, 0, 1, 0), {640, 480});
    cv::warpAffine(body_, body, cv::Matx23d(1, 0, body_left, 0, 1, 100), {640, 480});
    v.truth = cv::Mat::zeros(480, 640, CV_8UC1);
    const cv::Rect box(cvRound(body_left), 100, 120, 300);
    v.truth(box) = 255;
    v.grey = wall;
    body.copyTo(v.grey, v.truth);
    v.frame.index = index;
    v.frame.timestamp = time;
    cv::cvtColor(v.grey, v.frame.colour, cv::COLOR_GRAY2BGR);
    v.frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(3.0));
    for (int x = 0; x < box.width; ++x) {
      const double u = (x + 0.5) / box.width * 2.0 - 1.0;
      v.frame.depth.col(box.x + x).rowRange(100, 400) = 1.62 - 0.14 * std::sqrt(1.0 - u * u);
    }
    for (int y = 24; y < 470; y += 16) {
      for (int x = 24; x < 620; x += 16) {
        v.keypoints.emplace_back(static_cast<float>(x), static_cast<float>(y), 7.0F);
      }
    }
    v.detection.box = {static_cast<float>(body_left) - 15, 90, 150, 320};
    v.detection.class_id = 0;
    v.detection.score = 0.8F;
    return v;
  }

 private:
  double speed_;
  cv::Mat wall_ = texture({700, 480}, 1), body_ = texture({120, 300}, 2);
};

struct Score {
  double removed = 0.0, kept = 0.0, iou = 0.0;
};

Score score(const World::View& v, const FrameDynamics& result) {
  int inside = 0, removed = 0, outside = 0, kept = 0;
  for (std::size_t i = 0; i < v.keypoints.size(); ++i) {
    const bool in = v.truth.at<std::uint8_t>(v.keypoints[i].pt) != 0;
    const bool still = result.features[i].is_static;
    (in ? inside : outside) += 1;
    removed += in && !still ? 1 : 0;
    kept += !in && still ? 1 : 0;
  }
  Score s{static_cast<double>(removed) / inside, static_cast<double>(kept) / outside, 0.0};
  if (!result.mask.empty()) {
    s.iou = static_cast<double>(cv::countNonZero(result.mask & v.truth)) /
            cv::countNonZero(result.mask | v.truth);
  }
  return s;
}

/// Runs frames 0..last, the detector blind from frame `blind_from` on; scores the last one.
Score run(DynamicsMode mode, double speed, int last, int blind_from) {
  DynamicsOptions options;
  options.mode = mode;
  DynamicsModule module(testing::vga_camera(), options);
  const World world(speed);
  Score result;
  for (int i = 0; i <= last; ++i) {
    const auto v = world.at(i);
    std::vector<Detection> detections;
    if (i < blind_from) detections.push_back(v.detection);
    const auto r =
        module.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, detections});
    result = score(v, r);
  }
  return result;
}

TEST(DynamicsModule, OffKeepsAllAndDoesNothing) {
  const World world(0.75);
  DynamicsOptions options;
  options.mode = DynamicsMode::off;
  DynamicsModule module(testing::vga_camera(), options);
  const auto v = world.at(0);
  const FrameDynamics result =
      module.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
  EXPECT_TRUE(result.objects.empty());
  EXPECT_TRUE(result.mask.empty());
  ASSERT_EQ(result.features.size(), v.keypoints.size());
  for (const auto& f : result.features) EXPECT_TRUE(f.is_static);
}

TEST(DynamicsModule, EveryModeRemovesTheWalker) {
  const Score d = run(DynamicsMode::d, 0.75, 5, 100);
  const Score dk = run(DynamicsMode::dk, 0.75, 5, 100);
  const Score plus = run(DynamicsMode::dkp_plus, 0.75, 5, 100);
  EXPECT_GE(d.removed, 0.99);
  EXPECT_GE(dk.removed, 0.96);
  EXPECT_GE(plus.removed, 0.98);
  EXPECT_GT(dk.kept, d.kept);
  EXPECT_GT(dk.kept, 0.97);
  EXPECT_GT(plus.kept, 0.93);
  EXPECT_GT(plus.iou, 0.95);
}

TEST(DynamicsModule, CarriesTheWalkerThroughMissedDetections) {
  const Score plus = run(DynamicsMode::dkp_plus, 0.75, 20, 4);
  EXPECT_GE(plus.removed, 0.97);
  EXPECT_GT(plus.kept, 0.9);
  EXPECT_GT(plus.iou, 0.9);
  const Score dk = run(DynamicsMode::dk, 0.75, 20, 4);
  EXPECT_GE(dk.removed, 0.9);
}

TEST(DynamicsModule, FindsAWalkerWhomNoDetectorSaw) {
  const Score plus = run(DynamicsMode::dkp_plus, 0.75, 10, 0);
  EXPECT_GE(plus.removed, 0.95);
  EXPECT_GT(plus.kept, 0.95);
  EXPECT_GT(plus.iou, 0.9);
  EXPECT_LT(run(DynamicsMode::dk, 0.75, 10, 0).removed, 0.01);
}

TEST(DynamicsModule, SeesTheCameraMoveBesideMasksWhereTooLittleLiesBesideBoxes) {
  const World world(0.75);
  DynamicsOptions options;
  options.clustering.planes.max_planes = 0;  // no wall that would tell
  options.motion.min_low_points = 840;       // outside the box lie 800, outside his mask 890
  options.motion.enough_outside = 2000;
  options.motion.followed_outside = 0;  // all
  DynamicsModule module(testing::vga_camera(), options, 1);
  for (int i = 0; i < 4; ++i) {
    World::View v = world.at(i);
    v.detection.box += cv::Point2f(-20.0F, -20.0F);
    v.detection.box += cv::Size2f(40.0F, 40.0F);
    const FrameDynamics result =
        module.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
    if (i == 0) continue;
    ASSERT_TRUE(result.current_from_previous) << i;
    EXPECT_NEAR(result.current_from_previous->translation.x(), -0.1 / 30.0, 1e-3) << i;
  }
}

TEST(DynamicsModule, JudgesFeaturesThatAreAddedInBoxesByTheirFlow) {
  // Of the lower half of the walker no depth is read: no mask holds it.
  for (const DynamicsMode mode : {DynamicsMode::dkp_plus, DynamicsMode::dk}) {
    DynamicsOptions options;
    options.mode = mode;
    DynamicsModule module(testing::vga_camera(), options);
    const World world(0.75);
    World::View v;
    FrameDynamics result;
    for (int i = 0; i <= 4; ++i) {
      v = world.at(i);
      v.frame.depth.rowRange(250, 400).setTo(0.0F, v.truth.rowRange(250, 400));
      result =
          module.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
    }
    const std::size_t first = v.keypoints.size();
    const cv::Point2f corner = v.detection.box.tl();
    v.keypoints.emplace_back(corner + cv::Point2f(75, 270), 7.0F);  // on him
    v.keypoints.emplace_back(corner + cv::Point2f(7, 4), 7.0F);     // on the wall beside him
    v.keypoints.emplace_back(corner + cv::Point2f(-60, 80), 7.0F);  // outside the box
    result.features.resize(v.keypoints.size());
    module.judge_added(v.frame, v.keypoints, first, result);
    EXPECT_EQ(result.features[first].is_static, mode == DynamicsMode::dk);
    EXPECT_TRUE(result.features[first + 1].is_static);
    EXPECT_TRUE(result.features[first + 2].is_static);
  }
}

TEST(DynamicsModule, PaperCompensatesForOneMissedFrameWithoutABox) {
  const Score seen = run(DynamicsMode::paper, 0.75, 5, 100);
  const Score missed = run(DynamicsMode::paper, 0.75, 5, 5);
  EXPECT_GE(seen.removed, 0.6);  // he walks along the epipolar lines, which hides him
  EXPECT_GE(missed.removed, seen.removed - 0.1);
  EXPECT_EQ(missed.iou, 0.0);  // no box, no mask
  EXPECT_GT(missed.kept, 0.9);
}

/// Runs frames 0..last with answers about images `late` frames ago; scores the last one. Frames
/// that `answered` refuses get no answer.
Score run_late(const DynamicsOptions& options, int last, int late,
               const std::function<bool(int)>& answered) {
  DynamicsModule module(testing::vga_camera(), options);
  const World world(0.75);
  Score result;
  for (int i = 0; i <= last; ++i) {
    const auto v = world.at(i);
    DetectionResult answer;
    if (i >= late && answered(i)) {
      const auto before = world.at(i - late);
      answer = {before.frame.timestamp, true, {before.detection}};
    }
    result = score(v, module.process(v.frame, v.grey, v.keypoints, answer));
  }
  return result;
}

TEST(DynamicsModule, AnswersOfEarlierImagesAreWorthAsMuch) {
  const auto always = [](int) { return true; };
  for (const DynamicsMode mode : {DynamicsMode::d, DynamicsMode::dk, DynamicsMode::dkp_plus}) {
    SCOPED_TRACE(mode_info(mode).name);
    DynamicsOptions options;
    options.mode = mode;
    const Score late = run_late(options, 18, 12, always);  // 0.4 s, in which he walks 90 px
    EXPECT_GE(late.removed, 0.95);
    EXPECT_GE(late.kept, 0.9 * run_late(options, 18, 0, always).kept);
  }
}

TEST(DynamicsModule, BetweenAnswersObjectsLiveOnWithoutCompensationToo) {
  DynamicsOptions options;
  options.mode = DynamicsMode::dk;
  options.compensation.compensate = false;
  const auto once = [](int i) { return i == 6; };
  EXPECT_GE(run_late(options, 6, 3, once).removed, 0.95);  // starts from a late answer
  EXPECT_GE(run_late(options, 18, 3, once).removed, 0.9);
}

TEST(DynamicsModule, ASilentDetectorRemovesNothingInTheAblation) {
  const auto never = [](int) { return false; };
  for (const DynamicsMode mode : {DynamicsMode::paper, DynamicsMode::d, DynamicsMode::dk}) {
    DynamicsOptions options;
    options.mode = mode;
    EXPECT_LT(run_late(options, 6, 0, never).removed, mode == DynamicsMode::paper ? 0.6 : 1e-6);
  }
}

/// Depth images are taken `ahead` frames after the colour images, those by their stamps
/// `stamped_ahead`; mean IoU of frames 5 to 14.
double iou_with_depth_ahead(int ahead, int stamped_ahead, bool compare) {
  DynamicsOptions options;
  if (!compare) options.mask_depth.every = 0;
  DynamicsModule module(testing::vga_camera(), options);
  const World world(0.75);
  double sum = 0.0;
  for (int i = 0; i < 15; ++i) {
    World::View v = world.at(i);
    v.grey *= 0.25;  // a texture without edges of its own
    cv::add(v.grey, cv::Scalar(150), v.grey, v.truth == 0);
    v.frame.depth = world.at(i + ahead).frame.depth;
    v.frame.stamped_depth = world.at(i + stamped_ahead).frame.depth;
    const auto r =
        module.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
    if (i >= 5) sum += score(v, r).iou / 10.0;
  }
  return sum;
}

TEST(DynamicsModule, CutsMasksFromTheDepthImageThatFits) {
  EXPECT_GT(iou_with_depth_ahead(0, 2, true), 0.95);
  EXPECT_GT(iou_with_depth_ahead(2, 0, true), 0.95) << "a delay that people do not have";
  EXPECT_LT(iou_with_depth_ahead(2, 0, false), 0.85) << "he walks 7.6 pixels a frame";
}

TEST(DynamicsModule, RepeatsExactly) {
  const World world(0.75);
  DynamicsModule a(testing::vga_camera(), {}), b(testing::vga_camera(), {});
  for (int i = 0; i < 4; ++i) {
    const auto v = world.at(i);
    const auto ra =
        a.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
    const auto rb =
        b.process(v.frame, v.grey, v.keypoints, {v.frame.timestamp, true, {v.detection}});
    ASSERT_EQ(cv::countNonZero(ra.mask != rb.mask), 0);
    for (std::size_t k = 0; k < ra.features.size(); ++k) {
      ASSERT_EQ(ra.features[k].is_static, rb.features[k].is_static);
    }
  }
}

TEST(DynamicsModule, RefusesImagesOfAnotherSize) {
  DynamicsModule module(testing::vga_camera(), {});
  auto v = World(0.75).at(0);
  EXPECT_THROW(module.process(v.frame, v.grey(cv::Rect(0, 0, 100, 100)), v.keypoints,
                              {v.frame.timestamp, true, {}}),
               Error);
  Camera broken = testing::vga_camera();
  broken.fx = 0.0;
  EXPECT_THROW(DynamicsModule(broken, {}), Error);
}

}  // namespace
}  // namespace dkp_slam

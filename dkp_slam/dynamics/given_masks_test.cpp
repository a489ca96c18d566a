#include "dkp_slam/dynamics/given_masks.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/dynamics_module.h"

namespace dkp_slam {
namespace {

constexpr int width = 160, height = 120;
const cv::Rect left(20, 30, 30, 40), right(100, 20, 30, 60);

/// A frame with two people in its mask, moved to the right by so many pixels; no mask for `given`
/// false.
RgbdFrame frame_at(double time, int moved = 0, bool given = true) {
  RgbdFrame frame;
  frame.timestamp = time;
  frame.colour = cv::Mat::zeros(height, width, CV_8UC3);
  if (!given) return frame;
  frame.mask = cv::Mat::zeros(height, width, CV_8UC1);
  frame.mask(left + cv::Point(moved, 0)) = 1;
  frame.mask(right + cv::Point(moved, 0)) = 200;
  return frame;
}

/// Features every five pixels; those now on a person came from `shift` pixels further left, the
/// others from where they are.
struct Features {
  std::vector<cv::Point2f> points;
  FlowResult tracks;
  explicit Features(float shift) {
    for (int y = 2; y < height; y += 5) {
      for (int x = 2; x < width; x += 5) {
        const cv::Point2f now(static_cast<float>(x), static_cast<float>(y));
        const cv::Point2f then = now - cv::Point2f(shift, 0.0F);
        const bool moves = left.contains(cv::Point(then)) || right.contains(cv::Point(then));
        points.push_back(now);
        tracks.previous.push_back(moves ? then : now);
        tracks.tracked.push_back(1);
      }
    }
  }
};

TEST(GivenMasks, PiecesAreToldApart) {
  GivenMasks masks(1.0);
  const Features still(0.0F);
  const cv::Mat labels = masks.labels(frame_at(0.0), still.points, still.tracks);
  const int first = labels.at<std::uint8_t>(left.tl()),
            second = labels.at<std::uint8_t>(right.tl());
  EXPECT_EQ(first + second, 3);  // 1 and 2
  EXPECT_EQ(cv::countNonZero(labels == first), left.area());
  EXPECT_EQ(cv::countNonZero(labels), left.area() + right.area());
}

TEST(GivenMasks, WithoutOneTheLastGoesOnWithTheFlowForAWhile) {
  GivenMasks masks(1.0);
  const Features moving(8.0F);
  masks.labels(frame_at(0.0), moving.points, moving.tracks);
  const cv::Mat carried = masks.labels(frame_at(0.5, 0, false), moving.points, moving.tracks);
  const cv::Mat expected = frame_at(0.5, 8).mask != 0;
  EXPECT_EQ(cv::norm(carried != 0, expected, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::countNonZero(masks.labels(frame_at(1.1, 0, false), moving.points, moving.tracks)),
            0);
}

TEST(GivenMasks, BeforeTheFirstNothingIsKnown) {
  GivenMasks masks(1.0);
  const Features still(0.0F);
  const cv::Mat labels = masks.labels(frame_at(0.0, 0, false), still.points, still.tracks);
  EXPECT_EQ(labels.size(), cv::Size(width, height));
  EXPECT_EQ(cv::countNonZero(labels), 0);
}

TEST(GivenMasks, AreTheDynamicRegionAndNothingElseIs) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  DynamicsOptions options;
  options.mode = DynamicsMode::masks;
  DynamicsModule module(camera, options);
  cv::Mat grey(height, width, CV_8UC1);
  cv::RNG(3).fill(grey, cv::RNG::UNIFORM, 0, 256);
  std::vector<cv::KeyPoint> keypoints;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) keypoints.emplace_back(cv::Point2f(cv::Point(x, y)), 7.0F);
  }
  RgbdFrame frame = frame_at(0.0);
  frame.depth = cv::Mat(height, width, CV_32FC1, cv::Scalar(2.0));
  // What a detector says counts for nothing.
  Detection person;
  person.box = cv::Rect2f(0, 0, width, height);
  person.class_id = 0;
  person.score = 1.0F;
  const FrameDynamics result = module.process(frame, grey, keypoints, {0.0, true, {person}});
  EXPECT_EQ(cv::norm(result.mask, frame.mask != 0, cv::NORM_INF), 0.0);
  const int margin = options.removal.given_margin;
  const auto grown = [&](const cv::Rect& r) {
    return cv::Rect(r.tl() - cv::Point(margin, margin), r.br() + cv::Point(margin, margin));
  };
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::Point at(keypoints[i].pt);
    EXPECT_EQ(result.features[i].is_static, !grown(left).contains(at) && !grown(right).contains(at))
        << at;
    EXPECT_EQ(result.features[i].region == Region::high, left.contains(at) || right.contains(at))
        << at;
  }
}

}  // namespace
}  // namespace dkp_slam

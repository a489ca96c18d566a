#include "dkp_slam/dynamics/motion/lucas_kanade.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/video/tracking.hpp>

#include "dkp_slam/dynamics/motion/test_texture.h"

namespace dkp_slam {
namespace {

using testing::height;
using testing::texture;
using testing::width;

std::vector<cv::Point2f> grid(int margin) {
  std::vector<cv::Point2f> points;
  for (int v = margin; v < height - margin; v += 17) {
    for (int u = margin; u < width - margin; u += 13) {
      points.emplace_back(static_cast<float>(u) + 0.3F, static_cast<float>(v) + 0.6F);
    }
  }
  return points;
}

const LucasKanadeSearch usual{.window = {16, 12}};

std::vector<cv::Mat> pyramid_of(const cv::Mat& image, const LucasKanadeSearch& search = usual) {
  std::vector<cv::Mat> pyramid;
  make_pyramid(image, search, pyramid);
  return pyramid;
}

/// Largest distance from where (`right`, `down`) takes the points, and how many were found.
struct Outcome {
  double worst = 0.0;
  std::size_t found = 0;
};

Outcome follow(double right, double down, const LucasKanadeSearch& search) {
  const auto from = pyramid_of(texture(0, 0), search),
             to = pyramid_of(texture(right, down), search);
  const auto points = grid(40);
  auto found = points;
  const auto tracked = lucas_kanade(from, to, points, found, search);
  Outcome outcome;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (tracked[i] == 0) continue;
    ++outcome.found;
    const cv::Point2f truth =
        points[i] + cv::Point2f(static_cast<float>(right), static_cast<float>(down));
    outcome.worst = std::max(outcome.worst, cv::norm(found[i] - truth));
  }
  return outcome;
}

TEST(LucasKanade, FindsWhatMovedByAFractionOfAPixel) {
  const Outcome outcome = follow(0.37, -0.61, usual);
  EXPECT_EQ(outcome.found, grid(40).size());
  EXPECT_LT(outcome.worst, 0.05);
}

TEST(LucasKanade, CoarseLevelsReachFurther) {
  EXPECT_LT(follow(7.3, -5.2, usual).worst, 0.1);
  LucasKanadeSearch flat = usual;
  flat.levels = 0;
  EXPECT_GT(follow(7.3, -5.2, flat).worst, 1.0);
}

TEST(LucasKanade, AtTheEdgeWhatLiesInTheImageCounts) {
  const auto from = pyramid_of(texture(0, 0)), to = pyramid_of(texture(-6.3, 4.4));
  std::vector<cv::Point2f> points;
  for (int v = 40; v < height - 40; v += 9) {
    points.emplace_back(static_cast<float>(width - 2 - v % 7), static_cast<float>(v));
  }
  auto found = points;
  const auto tracked = lucas_kanade(from, to, points, found, usual);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(tracked[i], 1);
    EXPECT_LT(cv::norm(found[i] - points[i] - cv::Point2f(-6.3F, 4.4F)), 0.7) << points[i];
  }
}

TEST(LucasKanade, WindowsOfAnySizeWork) {
  for (const cv::Size window :
       {cv::Size(3, 3), cv::Size(9, 21), cv::Size(15, 15), cv::Size(31, 7)}) {
    LucasKanadeSearch search = usual;
    search.window = window;
    const Outcome outcome = follow(0.4, 0.3, search);
    EXPECT_GT(outcome.found, grid(40).size() * 9 / 10) << window;
    EXPECT_LT(outcome.worst, window.area() < 20 ? 0.5 : 0.1) << window;
  }
}

TEST(LucasKanade, GivesTheSameBitsWithFewerInstructions) {
  const auto from = pyramid_of(texture(0, 0)), to = pyramid_of(texture(3.2, -1.7));
  for (const int columns : {3, 7, 8, 13, 16, 21}) {
    LucasKanadeSearch search = usual;
    search.window.width = columns;
    LucasKanadeSearch baseline = search;
    baseline.baseline = true;
    const auto points = grid(0);
    auto found = points, found_baseline = points;
    EXPECT_EQ(
        lucas_kanade(pyramid_of(texture(0, 0), search), pyramid_of(texture(3.2, -1.7), search),
                     points, found, search),
        lucas_kanade(pyramid_of(texture(0, 0), search), pyramid_of(texture(3.2, -1.7), search),
                     points, found_baseline, baseline));
    EXPECT_EQ(found, found_baseline) << columns;
  }
}

TEST(LucasKanade, AgreesWithOpenCv) {
  const cv::Mat a = texture(0, 0), b = texture(5.4, 2.1);
  const auto points = grid(40);
  auto found = points, found_there = points;
  const auto tracked = lucas_kanade(pyramid_of(a), pyramid_of(b), points, found, usual);
  std::vector<uchar> tracked_there;
  cv::calcOpticalFlowPyrLK(
      a, b, points, found_there, tracked_there, cv::noArray(), usual.window, usual.levels,
      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, usual.iterations, usual.epsilon},
      cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(tracked[i], tracked_there[i]) << points[i];
    EXPECT_LT(cv::norm(found[i] - found_there[i]), 0.05) << points[i];
  }
}

TEST(LucasKanade, WhatHasNoCornersIsNotFound) {
  const cv::Mat plain(height, width, CV_8UC1, cv::Scalar(90));
  cv::Mat stripes(height, width, CV_8UC1);
  for (int u = 0; u < width; ++u) stripes.col(u).setTo(128 + 60 * std::sin(0.3 * u));
  for (const cv::Mat& image : {plain, stripes}) {
    const auto pyramid = pyramid_of(image);
    const auto points = grid(40);
    auto found = points;
    EXPECT_EQ(lucas_kanade(pyramid, pyramid, points, found, usual),
              std::vector<std::uint8_t>(points.size(), 0));
  }
}

TEST(LucasKanade, PointsAnywhereAreRefusedOrFound) {
  const auto pyramid = pyramid_of(texture(0, 0));
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<cv::Point2f> outside{{-20, 100}, {nan, 4}, {4, nan}, {1e30F, 7}, {400, -1e9F}};
  auto found = outside;
  EXPECT_EQ(lucas_kanade(pyramid, pyramid, outside, found, usual),
            std::vector<std::uint8_t>(outside.size(), 0));
  const std::vector<cv::Point2f> corners{
      {0, 0}, {width - 1, 0}, {0, height - 1}, {width - 1, height - 1}, {0.5F, 120}};
  for (const float away : {-300.0F, -9.0F, 0.0F, 9.0F, 300.0F}) {
    found = corners;
    for (cv::Point2f& p : found) p += {away, away};
    const auto tracked = lucas_kanade(pyramid, pyramid, corners, found, usual);
    if (away != 0.0F) continue;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (tracked[i] != 0) {
        EXPECT_LT(cv::norm(found[i] - corners[i]), 0.01);
      }
    }
  }
}

}  // namespace
}  // namespace dkp_slam

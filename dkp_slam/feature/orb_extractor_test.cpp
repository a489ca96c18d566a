#include "dkp_slam/feature/orb_extractor.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

cv::Mat texture(unsigned seed) {
  cv::RNG random(seed);
  cv::Mat image(480, 640, CV_8UC1);
  random.fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, {}, 2.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

TEST(OrbExtractor, FindsAboutTheNumberAskedForAndSpreadsThem) {
  OrbExtractor extractor;
  const OrbFeatures features = extractor.extract(texture(1));
  EXPECT_NEAR(static_cast<double>(features.keypoints.size()), 1000.0, 60.0);
  ASSERT_EQ(features.keypoints.size(), features.descriptors.size());
  std::vector<int> per_cell(16, 0);
  for (const cv::KeyPoint& k : features.keypoints) {
    ++per_cell[static_cast<int>(k.pt.y) / 120 * 4 + static_cast<int>(k.pt.x) / 160];
  }
  for (int n : per_cell) EXPECT_GT(n, 30);
}

TEST(OrbExtractor, WeakTextureBesideStrongGetsItsShare) {
  cv::Mat image = texture(2);
  cv::Mat left = image.colRange(0, 320);
  left = left * 0.12 + 100;  // contrast under the first threshold
  OrbExtractor extractor;
  int weak = 0;
  for (const cv::KeyPoint& k : extractor.extract(image).keypoints) weak += k.pt.x < 310;
  EXPECT_GT(weak, 130);
}

TEST(OrbExtractor, TakesMoreCornersWhereTheyAreAllowedAndAllOfThemThere) {
  const cv::Mat image = texture(4);
  cv::Mat allowed = cv::Mat::zeros(image.size(), CV_8UC1);
  allowed(cv::Rect(100, 200, 240, 180)) = 1;
  const OrbExtractor extractor;
  const OrbFeatures found = extractor.extract(image);
  const OrbFeatures more = extractor.extract_more(found, allowed);
  const cv::Rect2f area(98.0F, 198.0F, 245.0F, 185.0F);  // a level's pixel is up to 3.6 wide
  std::set<std::tuple<int, float, float>> places;
  for (const cv::KeyPoint& k : found.keypoints) places.insert({k.octave, k.pt.x, k.pt.y});
  for (const cv::KeyPoint& k : more.keypoints) {
    EXPECT_TRUE(area.contains(k.pt)) << k.pt;
    EXPECT_TRUE(places.insert({k.octave, k.pt.x, k.pt.y}).second) << "twice: " << k.pt;
  }
  const auto there = std::count_if(found.keypoints.begin(), found.keypoints.end(),
                                   [&](const cv::KeyPoint& k) { return area.contains(k.pt); });
  EXPECT_GT(there + static_cast<std::ptrdiff_t>(more.keypoints.size()), 600);
}

TEST(OrbExtractor, FindsTheSameAgainWhereEverythingIsAllowed) {
  const cv::Mat image = texture(5);
  const cv::Mat everywhere(image.size(), CV_8UC1, cv::Scalar(1));
  for (const double enlargement : {1.0, 1.5}) {
    OrbOptions options;
    options.enlargement = enlargement;
    const OrbExtractor extractor(options);
    OrbFeatures found = extractor.extract(image);
    EXPECT_TRUE(extractor.extract_more(found, everywhere).keypoints.empty());
    // What is taken away is found again, with the same descriptor.
    const cv::KeyPoint k = found.keypoints.back();
    const Descriptor d = found.descriptors.back();
    found.keypoints.pop_back();
    found.descriptors.pop_back();
    const OrbFeatures again = extractor.extract_more(found, everywhere);
    ASSERT_EQ(again.keypoints.size(), 1U);
    EXPECT_EQ(again.keypoints[0].pt, k.pt);
    EXPECT_EQ(again.keypoints[0].octave, k.octave);
    EXPECT_EQ(again.keypoints[0].angle, k.angle);
    EXPECT_EQ(again.descriptors[0], d);
  }
}

TEST(OrbExtractor, FollowsAShiftAndARightAngle) {
  const cv::Mat image = texture(3);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  OrbExtractor extractor;
  const OrbFeatures a = extractor.extract(image), b = extractor.extract(turned);
  int close = 0, right = 0;
  for (std::size_t i = 0; i < a.keypoints.size(); ++i) {
    const NearestTwo match = nearest_two(a.descriptors[i], b.descriptors);
    if (match.best_distance > 40) continue;
    ++close;
    const cv::Point2f p = a.keypoints[i].pt, q = b.keypoints[match.best].pt;
    right += cv::norm(q - cv::Point2f(479 - p.y, p.x)) < 3.0;
  }
  EXPECT_GT(close, 300);
  EXPECT_GT(right, 0.95 * close);
}

TEST(OrbExtractor, CornersOfAnEnlargedImageLieWhereTheyAre) {
  const cv::Mat image = texture(5);
  cv::Mat small;
  cv::resize(image, small, {320, 240}, 0, 0, cv::INTER_AREA);
  OrbOptions doubled;
  doubled.enlargement = 2.0;
  const OrbFeatures a = OrbExtractor().extract(image), b = OrbExtractor(doubled).extract(small);
  int close = 0, right = 0;
  cv::Point2f off;
  for (std::size_t i = 0; i < a.keypoints.size(); ++i) {
    const NearestTwo match = nearest_two(a.descriptors[i], b.descriptors);
    if (match.best_distance > 40) continue;
    ++close;
    const cv::Point2f p = a.keypoints[i].pt;
    const cv::Point2f d =
        b.keypoints[match.best].pt - cv::Point2f(0.5F * p.x - 0.25F, 0.5F * p.y - 0.25F);
    if (cv::norm(d) > 1.0) continue;
    ++right;
    off += d;
  }
  EXPECT_GT(close, 300);
  EXPECT_GT(right, 0.95 * close);
  // No shift between the two: less than a tenth of a pixel of the small image.
  EXPECT_LT(cv::norm(off) / right, 0.1);
}

TEST(OrbExtractor, SameImageSameFeatures) {
  OrbExtractor one, two;
  const OrbFeatures a = one.extract(texture(4)), b = two.extract(texture(4));
  ASSERT_EQ(a.keypoints.size(), b.keypoints.size());
  EXPECT_EQ(a.descriptors, b.descriptors);
}

TEST(OrbExtractor, FlatImageHasNoFeatures) {
  OrbExtractor extractor;
  EXPECT_TRUE(extractor.extract(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128))).keypoints.empty());
}

TEST(SpreadByQuadtree, KeepsTheStrongestOfAClump) {
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < 100; ++i)
    keypoints.emplace_back(10.0F + 0.01F * i, 10.0F, 7.0F, -1.0F, float(i));
  keypoints.emplace_back(90.0F, 90.0F, 7.0F, -1.0F, 1.0F);
  const auto kept = spread_by_quadtree(keypoints, {0, 0, 100, 100}, 2);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_FLOAT_EQ(std::max(kept[0].response, kept[1].response), 99.0F);
  EXPECT_FLOAT_EQ(std::min(kept[0].response, kept[1].response), 1.0F);
}

}  // namespace
}  // namespace dkp_slam

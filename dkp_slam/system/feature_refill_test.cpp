#include "dkp_slam/system/feature_refill.h"

#include <cstddef>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// Knows of no surface and has nothing against any feature.
FeatureRefill::Room nothing() {
  return {[] { return cv::Mat(); }, [](std::size_t) {}};
}

/// Somebody in a checked shirt who leaves a fifth of the view free, at its right.
class Crowded : public ::testing::Test {
 protected:
  Crowded() {
    cv::RNG random(1);
    random.fill(grey_, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(grey_, grey_, {0, 0}, 2.0);
    cv::normalize(grey_, grey_, 0, 255, cv::NORM_MINMAX);
    dynamics_.doubtful = cv::Mat::zeros(480, 640, CV_8UC1);
    dynamics_.doubtful.colRange(0, person_) = 255;
    features_ = OrbExtractor().extract(grey_);
    for (const cv::KeyPoint& k : features_.keypoints) {
      FeatureDynamics f;
      f.is_static = k.pt.x >= person_;
      dynamics_.features.push_back(f);
    }
  }
  int remaining() const {
    int n = 0;
    for (const FeatureDynamics& f : dynamics_.features) n += f.is_static;
    return n;
  }

  static constexpr int person_ = 512;  // pixels
  cv::Mat grey_ = cv::Mat(480, 640, CV_8UC1);
  OrbFeatures features_;
  FrameDynamics dynamics_;
};

TEST_F(Crowded, GetsItsFeaturesWhereTheRoomIsSeen) {
  const OrbFeatures before = features_;
  ASSERT_LT(remaining(), 250);
  FeatureRefill({}, {}).refill(nothing(), features_, dynamics_);
  EXPECT_GT(remaining(), 600);
  ASSERT_EQ(features_.keypoints.size(), dynamics_.features.size());
  ASSERT_EQ(features_.descriptors.size(), dynamics_.features.size());
  std::set<std::tuple<int, float, float>> places;
  for (std::size_t i = 0; i < features_.keypoints.size(); ++i) {
    const cv::KeyPoint& k = features_.keypoints[i];
    EXPECT_TRUE(places.insert({k.octave, k.pt.x, k.pt.y}).second) << "twice: " << k.pt;
    if (i < before.keypoints.size()) {
      EXPECT_EQ(k.pt, before.keypoints[i].pt);
      EXPECT_EQ(features_.descriptors[i], before.descriptors[i]);
    } else {
      EXPECT_GE(k.pt.x, person_ + FeatureRefillOptions{}.margin - 3);  // pixels of coarse levels
      EXPECT_TRUE(dynamics_.features[i].is_static);
    }
  }
}

TEST_F(Crowded, NeedsNoMoreWhereEnoughIsLeft) {
  FeatureRefillOptions options;
  options.below = remaining();
  const std::size_t before = features_.keypoints.size();
  FeatureRefill({}, options).refill(nothing(), features_, dynamics_);
  EXPECT_EQ(features_.keypoints.size(), before);
  options.below = remaining() + 1;
  FeatureRefill({}, options).refill(nothing(), features_, dynamics_);
  EXPECT_GT(features_.keypoints.size(), before);
}

TEST_F(Crowded, GetsMoreWhereTheRoomIsKnown) {
  FeatureRefillOptions options;
  options.below = 0;
  const int before = remaining(), first = static_cast<int>(features_.keypoints.size());
  const cv::Rect known(540, 100, 80, 300);
  const auto surfaces = [&known] {
    cv::Mat all = cv::Mat::zeros(480, 640, CV_8UC1);
    all(known) = 255;
    return all;
  };
  std::vector<std::size_t> judged;
  const auto judge = [&judged](std::size_t from) { judged.push_back(from); };
  options.known_below = before;
  FeatureRefill({}, options).refill({surfaces, judge}, features_, dynamics_);
  EXPECT_EQ(remaining(), before);
  EXPECT_TRUE(judged.empty());
  options.known_below = before + 1;
  FeatureRefill({}, options).refill({surfaces, judge}, features_, dynamics_);
  EXPECT_GT(remaining(), before + 200);
  EXPECT_EQ(judged, std::vector<std::size_t>{static_cast<std::size_t>(first)});
  for (std::size_t i = static_cast<std::size_t>(first); i < features_.keypoints.size(); ++i) {
    const cv::Point2f& p = features_.keypoints[i].pt;
    const float inside =
        static_cast<float>(options.known_inside) - 3.0F;  // pixels of coarse levels
    EXPECT_TRUE(p.x >= 540 + inside && p.x < 620 - inside && p.y >= 100 + inside &&
                p.y < 400 - inside)
        << p;
  }
}

TEST_F(Crowded, IsLeftAloneWhereNobodyIs) {
  dynamics_.doubtful = cv::Mat();
  const std::size_t before = features_.keypoints.size();
  FeatureRefill({}, {}).refill(nothing(), features_, dynamics_);
  EXPECT_EQ(features_.keypoints.size(), before);
}

}  // namespace
}  // namespace dkp_slam

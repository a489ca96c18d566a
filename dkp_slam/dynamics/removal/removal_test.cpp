#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/dynamics/removal/epipolar_rule.h"
#include "dkp_slam/dynamics/removal/region_rules.h"
#include "dkp_slam/dynamics/removal/regions.h"
#include "dkp_slam/dynamics/removal/removal_options.h"
#include "dkp_slam/dynamics/removal/residual_rule.h"

namespace dkp_slam {
namespace {

FeatureDynamics feature(Region region, float weight, float d) {
  FeatureDynamics f;
  f.region = region;
  f.weight = weight;
  f.tracked = true;
  f.epipolar_distance = d;
  return f;
}

bool by_epipolar(const FeatureDynamics& f) {
  return EpipolarRule({}, {}, RemovalOptions{}.epsilon).is_static(f);
}

TEST(Regions, EquationSixAsMeantAndAsPrinted) {
  RegionOptions options;
  options.weight_high = 10.0F;
  EXPECT_FLOAT_EQ(suspicious_weight(0.0F, 50.0F, 0.5F, 10.0F, options), 10.0F);
  EXPECT_FLOAT_EQ(suspicious_weight(50.0F, 50.0F, 0.5F, 10.0F, options), 1.0F);
  EXPECT_NEAR(suspicious_weight(37.5F, 50.0F, 0.5F, 10.0F, options), 1.0F + 9.0F * 0.5F, 1e-5F);
  options.printed_equation = true;
  EXPECT_FLOAT_EQ(suspicious_weight(0.0F, 50.0F, 0.5F, 10.0F, options), 1.0F);
  EXPECT_FLOAT_EQ(suspicious_weight(50.0F, 50.0F, 0.5F, 10.0F, options), 10.0F);
}

TEST(Regions, FollowBoxAndMask) {
  cv::Mat labels = cv::Mat::zeros(480, 640, CV_8UC1);
  labels(cv::Rect(120, 120, 60, 60)) = 1;
  const std::vector<cv::Point2f> points = {{150, 150}, {181, 150}, {240, 240}, {400, 400}};
  const std::vector<ObjectRegions> objects = {{{100, 100, 150, 150}, 10.0F}};
  std::vector<FeatureDynamics> features(points.size());
  assign_regions(points, objects, labels, features);
  assign_weights(points, objects, labels, {}, features);
  EXPECT_EQ(features[0].region, Region::high);
  EXPECT_EQ(features[1].region, Region::suspicious);
  EXPECT_EQ(features[2].region, Region::suspicious);
  EXPECT_EQ(features[3].region, Region::low);
  EXPECT_FLOAT_EQ(features[0].weight, RegionOptions{}.weight_high);
  EXPECT_GT(features[1].weight, 0.9F * RegionOptions{}.weight_high);
  EXPECT_FLOAT_EQ(features[2].weight, 1.0F);  // the farthest of the box
  EXPECT_FLOAT_EQ(features[3].weight, 1.0F);
}

/// A person's box with a mask in it and a chair's box with one, and a feature in each place.
class Rules : public ::testing::Test {
 protected:
  Rules() {
    labels_(cv::Rect(120, 120, 60, 60)) = 1;
    labels_(cv::Rect(420, 120, 60, 60)) = 2;
    features_.resize(points_.size());
    motion_.residual.assign(points_.size(), 0.2F);
    motion_.long_residual.assign(points_.size(), 0.2F);
    assign_regions(points_, objects_, labels_, features_);
  }
  std::vector<bool> kept_by(const FeatureClassifier& rule) {
    for (FeatureDynamics& f : features_) {
      f.tracked = true;
      f.motion_residual = 0.2F;
    }
    rule.classify({points_, objects_, labels_, depth_, motion_}, features_);
    std::vector<bool> kept;
    for (const FeatureDynamics& f : features_) kept.push_back(f.is_static);
    return kept;
  }

  // In the person's mask, at its outline, in the box beside it; the same of the chair; outside.
  const std::vector<cv::Point2f> points_ = {{150, 150}, {180, 150}, {240, 240}, {450, 150},
                                            {480, 150}, {540, 240}, {300, 400}};
  const std::vector<ObjectRegions> objects_ = {{{100, 100, 150, 150}, 10.0F, true},
                                               {{400, 100, 150, 150}, 4.0F, false}};
  cv::Mat labels_ = cv::Mat::zeros(480, 640, CV_8UC1);
  cv::Mat depth_ = cv::Mat::zeros(480, 640, CV_32FC1);
  std::vector<FeatureDynamics> features_;
  FeatureMotion motion_;
};

TEST_F(Rules, BoxesOfWhatMovesByItselfGo) {
  EXPECT_EQ(kept_by(BoxRule()), (std::vector<bool>{false, false, false, true, true, true, true}));
}

TEST_F(Rules, MasksOfWhatMovesByItselfGo) {
  EXPECT_EQ(kept_by(MaskRule()), (std::vector<bool>{false, true, true, true, true, true, true}));
}

/// Options under which nothing comes back for the pose's sake.
RemovalOptions strict() {
  RemovalOptions options;
  options.least_static = 0;
  return options;
}

TEST_F(Rules, MasksOfPeopleGoWithTheirOutlinesAndElseWhatIsSeenToMove) {
  const ResidualRule rule(strict());
  EXPECT_EQ(kept_by(rule), (std::vector<bool>{false, false, true, true, true, true, true}));
  motion_.long_residual[2] = motion_.long_residual[3] = 6.1F;
  motion_.long_residual[6] = 100.0F;  // outside the boxes
  EXPECT_EQ(kept_by(rule), (std::vector<bool>{false, false, false, false, true, true, true}));
}

TEST_F(Rules, WhatIsAtThePersonsDepthBesideTheMaskGoesWithIt) {
  depth_.setTo(2.0F);
  const auto kept = [&](const cv::Point& where, float depth) {
    const std::vector<cv::Point2f> points{where};
    depth_.at<float>(where) = depth;
    std::vector<FeatureDynamics> features(1);
    motion_.residual = motion_.long_residual = {0.2F};
    assign_regions(points, objects_, labels_, features);
    ResidualRule(strict()).classify({points, objects_, labels_, depth_, motion_}, features);
    return features[0].is_static;
  };
  EXPECT_FALSE(kept({190, 150}, 2.05F));
  EXPECT_TRUE(kept({190, 150}, 2.1F));
  EXPECT_TRUE(kept({190, 150}, 0.0F));   // not known
  EXPECT_TRUE(kept({196, 150}, 2.05F));  // 17 pixels from the mask
  EXPECT_TRUE(kept({490, 150}, 2.05F));  // beside the chair's
}

TEST_F(Rules, WhatIsSeenToMoveIsMoreThanTheNoise) {
  motion_.long_residual.assign(points_.size(), 7.0F);
  motion_.camera_motion.emplace();
  motion_.camera_motion->noise = 1.7;  // four of these are 6.8 px
  EXPECT_EQ(kept_by(ResidualRule(strict())),
            (std::vector<bool>{false, false, false, false, false, false, true}));
  motion_.camera_motion->noise = 1.8;  // and of these 7.2
  EXPECT_EQ(kept_by(ResidualRule(strict())),
            (std::vector<bool>{false, false, true, true, true, true, true}));
}

TEST_F(Rules, OnlyInBoxesWhatMovesFromFrameToFrameGoesIfFlowCouldFollowIt) {
  const auto kept = [&](float residual, bool tracked) {
    for (FeatureDynamics& f : features_) {
      f.tracked = tracked;
      f.motion_residual = residual;
    }
    ResidualRule(strict()).classify({points_, objects_, labels_, depth_, motion_}, features_);
    std::vector<bool> all;
    for (const FeatureDynamics& f : features_) all.push_back(f.is_static);
    return all;
  };
  const std::vector<bool> masks_alone{false, false, true, true, true, true, true};
  EXPECT_EQ(kept(3.9F, true), masks_alone);
  EXPECT_EQ(kept(4.1F, true), (std::vector<bool>{false, false, false, false, false, false, true}));
  EXPECT_EQ(kept(20.0F, false), masks_alone);
}

TEST_F(Rules, WhatThePoseNeedsComesBackThatWhichMovesLeastFirst) {
  motion_.long_residual = {7.0F, 7.0F, 9.0F, 7.0F, 8.0F, 10.0F, 0.0F};
  RemovalOptions options;
  options.least_static = 3;
  EXPECT_EQ(kept_by(ResidualRule(options)),
            (std::vector<bool>{false, false, false, true, true, false, true}));
  const RemovalInput extra{points_, objects_, labels_, depth_, motion_, false};
  ResidualRule(options).classify(extra, features_);
  for (const FeatureDynamics& f : features_) EXPECT_EQ(f.is_static, &f == &features_.back());
  options.least_static = 100;  // masks and outlines stay away
  EXPECT_EQ(kept_by(ResidualRule(options)),
            (std::vector<bool>{false, false, true, true, true, true, true}));
}

TEST_F(Rules, WhatIsBesideAMaskComesBackToo) {
  depth_.setTo(2.0F);
  // Two beside the person's mask, at his depth, and one in his box farther off that is seen to
  // move.
  const std::vector<cv::Point2f> points{{188, 130}, {190, 150}, {240, 240}};
  depth_.at<float>(240, 240) = 3.0F;
  motion_.residual.assign(points.size(), 0.2F);
  const auto kept = [&](const std::vector<float>& residual, int least) {
    RemovalOptions options;
    options.least_static = least;
    std::vector<FeatureDynamics> features(points.size());
    motion_.long_residual = residual;
    assign_regions(points, objects_, labels_, features);
    ResidualRule(options).classify({points, objects_, labels_, depth_, motion_}, features);
    std::vector<bool> all;
    for (const FeatureDynamics& f : features) all.push_back(f.is_static);
    return all;
  };
  EXPECT_EQ(kept({2.0F, 1.0F, 9.0F}, 0), (std::vector<bool>{false, false, false}));
  EXPECT_EQ(kept({2.0F, 1.0F, 9.0F}, 1), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(kept({2.0F, 12.0F, 9.0F}, 2), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(kept({2.0F, 12.0F, 9.0F}, 3), (std::vector<bool>{true, true, true}));
}

TEST_F(Rules, KnowWhereNothingIsStaticUnseen) {
  const RemovalInput input{points_, objects_, labels_, depth_, motion_};
  const auto doubtful = [&](const FeatureClassifier& rule) {
    std::vector<bool> at;
    for (const cv::Point2f& p : points_) at.push_back(label_at(rule.doubtful(input), p) != 0);
    return at;
  };
  EXPECT_EQ(doubtful(BoxRule()), (std::vector<bool>{true, true, true, true, true, true, false}));
  EXPECT_EQ(doubtful(EpipolarRule({}, {}, 1.0F)), doubtful(BoxRule()));
  EXPECT_EQ(doubtful(MaskRule()),
            (std::vector<bool>{true, false, false, false, false, false, false}));
  EXPECT_EQ(doubtful(ResidualRule({})), doubtful(MaskRule()));
  EXPECT_EQ(doubtful(GivenMaskRule(2)),
            (std::vector<bool>{true, false, false, true, false, false, false}));
  const std::vector<ObjectRegions> nobody;
  EXPECT_TRUE(BoxRule().doubtful({points_, nobody, labels_, depth_, motion_}).empty());
}

TEST(Removal, PaperWeighsTheEpipolarDistance) {
  EXPECT_TRUE(by_epipolar(feature(Region::high, 4.0F, 0.2F)));
  EXPECT_FALSE(by_epipolar(feature(Region::high, 4.0F, 0.3F)));
  EXPECT_TRUE(by_epipolar(feature(Region::suspicious, 2.0F, 0.3F)));
  EXPECT_FALSE(by_epipolar(feature(Region::low, 1.0F, 1.2F)));
}

TEST(Removal, WhatFlowCannotFollowIsNoProofOfMotion) {
  FeatureDynamics lost;
  lost.region = Region::low;
  EXPECT_TRUE(by_epipolar(lost));
  lost.region = Region::suspicious;
  EXPECT_FALSE(by_epipolar(lost));
}

}  // namespace
}  // namespace dkp_slam

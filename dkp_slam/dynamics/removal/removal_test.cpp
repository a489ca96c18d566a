#include "dkp_slam/dynamics/removal/removal.h"

#include <gtest/gtest.h>

#include "dkp_slam/dynamics/removal/regions.h"

namespace dkp_slam {
namespace {

FeatureDynamics feature(Region region, float weight, float d, float residual) {
  FeatureDynamics f;
  f.region = region;
  f.weight = weight;
  f.tracked = true;
  f.epipolar_distance = d;
  f.motion_residual = residual;
  return f;
}

bool is_static(DynamicsMode mode, FeatureDynamics f, float object_weight) {
  std::vector<FeatureDynamics> features{f};
  FeatureEvidence evidence;
  evidence.object_weight = object_weight;
  classify(mode, {}, {evidence}, features);
  return features[0].is_static;
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

TEST(Removal, ModesOfTableSix) {
  const FeatureDynamics low = feature(Region::low, 1.0F, 0.2F, 0.2F);
  const FeatureDynamics suspicious = feature(Region::suspicious, 2.0F, 0.2F, 0.2F);
  const FeatureDynamics high = feature(Region::high, 4.0F, 0.3F, 3.0F);
  for (const auto mode : {DynamicsMode::off, DynamicsMode::d, DynamicsMode::dk, DynamicsMode::dkp,
                          DynamicsMode::dkp_plus}) {
    EXPECT_TRUE(is_static(mode, low, 0.0F));
    EXPECT_EQ(is_static(mode, suspicious, 10.0F), mode != DynamicsMode::d);
    EXPECT_EQ(is_static(mode, high, 10.0F), mode == DynamicsMode::off);
  }
}

TEST(Removal, PaperWeighsTheEpipolarDistance) {
  EXPECT_TRUE(is_static(DynamicsMode::dkp, feature(Region::high, 4.0F, 0.2F, 9.0F), 10.0F));
  EXPECT_FALSE(is_static(DynamicsMode::dkp, feature(Region::high, 4.0F, 0.3F, 0.0F), 10.0F));
  EXPECT_FALSE(is_static(DynamicsMode::dkp, feature(Region::low, 1.0F, 1.2F, 0.0F), 0.0F));
}

TEST(Removal, WhatFlowCannotFollowGoesInsideBoxesOnly) {
  FeatureDynamics lost;
  lost.region = Region::low;
  EXPECT_TRUE(is_static(DynamicsMode::dkp, lost, 0.0F));
  EXPECT_TRUE(is_static(DynamicsMode::dkp_plus, lost, 0.0F));
  lost.region = Region::suspicious;
  EXPECT_FALSE(is_static(DynamicsMode::dkp, lost, 10.0F));
  EXPECT_FALSE(is_static(DynamicsMode::dkp_plus, lost, 10.0F));
}

TEST(Removal, ThingsLoseOnlyTheirMovingPoints) {
  EXPECT_TRUE(is_static(DynamicsMode::dkp_plus, feature(Region::suspicious, 2, 0, 0.4F), 4.0F));
  EXPECT_FALSE(is_static(DynamicsMode::dkp_plus, feature(Region::suspicious, 2, 0, 2.5F), 4.0F));
  EXPECT_TRUE(is_static(DynamicsMode::dk, feature(Region::high, 2, 0, 0.4F), 4.0F));
}

}  // namespace
}  // namespace dkp_slam

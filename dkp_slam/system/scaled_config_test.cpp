#include "dkp_slam/system/scaled_config.h"

#include <gtest/gtest.h>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

SlamConfig config_of(int width, double rate) {
  SlamConfig config;
  config.camera.fx = config.camera.fy = 530.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.camera.frame_rate = rate;
  config.camera = resized(config.camera, width, width * 3 / 4);
  return config;
}

TEST(ScaledConfig, NothingChangesAtTheUsualSizeAndRate) {
  const SlamConfig config = config_of(640, 30.0), scaled = scaled_to_camera(config);
  EXPECT_EQ(scaled.tracking.motion_radius, config.tracking.motion_radius);
  EXPECT_EQ(scaled.measurement.pixel_sigma, config.measurement.pixel_sigma);
  EXPECT_EQ(scaled.orb.levels, config.orb.levels);
  EXPECT_EQ(scaled.orb.enlargement, 1.0);
  EXPECT_EQ(scaled.dynamics.removal.residual, config.dynamics.removal.residual);
  EXPECT_EQ(scaled.refill.margin, config.refill.margin);
  EXPECT_EQ(scaled.dynamics.surfaces.moving_short, config.dynamics.surfaces.moving_short);
  EXPECT_EQ(scaled.dynamics.motion.min_lag_pixels, config.dynamics.motion.min_lag_pixels);
  EXPECT_EQ(scaled.dynamics.motion.max_lag_pixels, config.dynamics.motion.max_lag_pixels);
  EXPECT_EQ(scaled.dynamics.motion.flow.history, config.dynamics.motion.flow.history);
  EXPECT_EQ(scaled.mapping.bundle_delay, config.mapping.bundle_delay);
  EXPECT_EQ(scaled.mapping.full.delay, config.mapping.full.delay);
}

TEST(ScaledConfig, AnglesAndSecondsStay) {
  const SlamConfig small = scaled_to_camera(config_of(320, 15.0));
  // Half the pixels for an angle, and twice the time for the prediction to go wrong.
  EXPECT_FLOAT_EQ(small.tracking.motion_radius, 12.0F);
  EXPECT_DOUBLE_EQ(small.measurement.pixel_sigma, 0.5);
  EXPECT_EQ(small.orb.levels, 8);
  EXPECT_DOUBLE_EQ(small.orb.enlargement, 2.0);
  EXPECT_EQ(small.mapping.bundle_delay, 3);
  EXPECT_EQ(small.mapping.full.delay, 15);
  const SlamConfig large = scaled_to_camera(config_of(1280, 30.0));
  EXPECT_FLOAT_EQ(large.tracking.motion_radius, 24.0F);
  EXPECT_EQ(large.orb.levels, 8);
  EXPECT_EQ(large.orb.enlargement, 1.0);
  EXPECT_DOUBLE_EQ(large.measurement.pixel_sigma, 1.0);
  EXPECT_EQ(large.mapping.bundle_delay, 6);
}

TEST(ScaledConfig, AnImageIsDoubledAtMost) {
  EXPECT_DOUBLE_EQ(scaled_to_camera(config_of(480, 30.0)).orb.enlargement, 640.0 / 480.0);
  const SlamConfig quarter = scaled_to_camera(config_of(160, 30.0));
  EXPECT_DOUBLE_EQ(quarter.orb.enlargement, 2.0);
  EXPECT_EQ(quarter.orb.levels, 4);  // 1.2^4 is the 2 that are left
}

TEST(ScaledConfig, PixelsOfTheDynamicsShrinkWithTheImage) {
  const DynamicsOptions small = scaled_to_camera(config_of(320, 30.0)).dynamics;
  EXPECT_FLOAT_EQ(small.removal.residual, 2.8284271F);  // 4 px, times the root of a half
  EXPECT_FLOAT_EQ(small.removal.residual_long, 4.2426407F);
  EXPECT_FLOAT_EQ(small.surfaces.moving_short, 1.0606602F);  // 1.5 px, times the root of a half
  EXPECT_FLOAT_EQ(small.surfaces.moving_long, 1.7677670F);
  EXPECT_FLOAT_EQ(small.surfaces.still_long, 0.84852814F);
  EXPECT_DOUBLE_EQ(small.motion.min_lag_pixels, 1.0);
  EXPECT_DOUBLE_EQ(small.motion.max_lag_pixels, 4.0);
  EXPECT_EQ(small.removal.mask_margin, 1);
  EXPECT_EQ(small.removal.depth_margin, 8);
  const DynamicsOptions large = scaled_to_camera(config_of(1280, 30.0)).dynamics;
  EXPECT_EQ(large.removal.residual, 4.0F);
  EXPECT_EQ(large.removal.depth_margin, 32);
  EXPECT_EQ(large.surfaces.moving_short, 1.5F);
  EXPECT_EQ(large.motion.max_lag_pixels, 8.0);
}

TEST(ScaledConfig, NewFeaturesKeepTheSameAngleFromPeople) {
  EXPECT_EQ(scaled_to_camera(config_of(320, 30.0)).refill.margin, 7);
  EXPECT_EQ(scaled_to_camera(config_of(1280, 30.0)).refill.margin, 28);
}

TEST(ScaledConfig, FlowReachesOverTheLongBaselineAtAnyRate) {
  EXPECT_EQ(scaled_to_camera(config_of(640, 60.0)).dynamics.motion.flow.history, 10);
  EXPECT_EQ(scaled_to_camera(config_of(640, 15.0)).dynamics.motion.flow.history, 5);
}

TEST(ScaledConfig, TheSmallestImageKeepsAPyramid) {
  EXPECT_EQ(scaled_to_camera(config_of(80, 30.0)).orb.levels, 3);
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/calibration/sighting_recorder.h"

#include <memory>

#include <gtest/gtest.h>

#include "dkp_slam/system/frame_result.h"

namespace dkp_slam {
namespace {

/// A surface whose inverse depth grows along u, seen by features that move 6 px a frame of 1/30 s.
std::shared_ptr<const FrameSnapshot> frame_at(double time, float u, double depth_delay) {
  auto snapshot = std::make_shared<FrameSnapshot>();
  snapshot->result.localised = true;
  snapshot->frame.timestamp = time;
  snapshot->frame.depth_delay = depth_delay;
  snapshot->frame.depth.create(480, 640, CV_32FC1);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x)
      snapshot->frame.depth.at<float>(y, x) = 1.0F / (0.4F + 1e-4F * static_cast<float>(x));
  }
  snapshot->keypoints = {cv::KeyPoint(u, 200.0F, 31.0F), cv::KeyPoint(u, 300.0F, 31.0F)};
  snapshot->landmarks = {7, -1};
  return snapshot;
}

std::vector<SightedFrame> recorded(double depth_delay) {
  SlamConfig config;
  config.camera.width = 640;
  config.camera.height = 480;
  SightingRecorder recorder(config);
  const double times[] = {1.0, 1.0 + 1.0 / 30.0};
  recorder.on_frame(frame_at(times[0], 300.0F, depth_delay));
  recorder.on_frame(frame_at(times[1], 306.0F, depth_delay));
  return recorder.frames_on({{times[0], Se3()}, {times[1], Se3()}});
}

TEST(SightingRecorder, ReadsDepthWhereTheFeatureWasThen) {
  for (const double delay : {-0.02, 0.01}) {
    const std::vector<SightedFrame> frames = recorded(delay);
    ASSERT_EQ(frames.size(), 2U);
    ASSERT_EQ(frames[1].sightings.size(), 1U);  // the other is no landmark
    EXPECT_NEAR(frames[1].depth_time - frames[1].time, delay, 1e-9);
    const SeenLandmark& seen = frames[1].sightings.front();
    EXPECT_EQ(seen.landmark, 7);
    EXPECT_EQ(seen.pixel, Eigen::Vector2d(306.0, 200.0));
    ASSERT_TRUE(seen.depth.known());
    EXPECT_NEAR(seen.depth.pixel.x(), 306.0 + 180.0 * delay, 0.51);  // whole pixels
    EXPECT_NEAR(seen.depth.inverse, 0.4 + 1e-4 * seen.depth.pixel.x(), 1e-5);
    EXPECT_NEAR(seen.depth.slope.x(), 1e-4, 1e-6);
    // Nobody knows how it moved before the first frame.
    EXPECT_FALSE(frames[0].sightings.front().depth.known());
  }
}

TEST(SightingRecorder, ReadsDepthAtTheFeatureWhereBothAreOfOneMoment) {
  const std::vector<SightedFrame> frames = recorded(0.0);
  ASSERT_EQ(frames.size(), 2U);
  ASSERT_TRUE(frames[0].sightings.front().depth.known());
  EXPECT_EQ(frames[0].sightings.front().depth.pixel, Eigen::Vector2d(300.0, 200.0));
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/system/start_keyframe.h"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {
namespace {

/// A wall 2 m before a camera that turns by 2 rad/s and reads its colour image in 20 ms; its depth
/// image is of one moment, 15 ms later.
class TurningStart : public ::testing::Test {
 protected:
  static constexpr double depth_delay = 0.015, interval = 1.0 / 30.0;  // seconds

  TurningStart() {
    camera_.width = 640;
    camera_.height = 480;
    camera_.fx = camera_.fy = 500.0;
    camera_.cx = 319.5;
    camera_.cy = 239.5;
    camera_.readout = 0.02;
    camera_.depth_readout = 0.0;
    velocity_ << 0.1, 0.0, 0.0, 0.3, 2.0, 0.0;
    map_ = std::make_unique<Map>(camera_, 1.2F, 8);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> u(40.0, 600.0), v(20.0, 460.0);
    image_.depth = depth_of(Se3::exp(depth_delay * velocity_));
    image_.depth_delay = depth_delay;
    for (int i = 0; i < 100; ++i) {
      // Of the wall's point that the middle row's camera would see at that pixel.
      points_.push_back(2.0 * camera_.unproject({u(random), v(random)}, 1.0));
      orb_.keypoints.emplace_back(seen(points_.back()), 31.0F, 0.0F, 1.0F, 0);
      orb_.descriptors.emplace_back();
    }
    frame_.index = 7;
    frame_.timestamp = 100.0;
    frame_.features = FrameFeatures(orb_, image_.depth, camera_);
    frame_.is_static.assign(100, 1);
    frame_.is_static[3] = 0;
    Keyframe keyframe;
    keyframe.features = frame_.features.subset(frame_.is_static);
    keyframe.landmarks.assign(99, -1);
    frame_.reference_keyframe = map_->add_keyframe(std::move(keyframe));
    const FrameFeatures& f = map_->keyframe(frame_.reference_keyframe).features;
    for (int i = 0; i < 99; ++i) {
      const auto s = static_cast<std::size_t>(i);
      map_->add_landmark(camera_.unproject({f.pixel[s].x, f.pixel[s].y}, f.depth[s]),
                         frame_.reference_keyframe, i);
    }
    next_.index = 8;
    next_.timestamp = frame_.timestamp + interval;
  }

  /// Depth image of the wall (z = 2 m in the first camera's frame) from another camera.
  cv::Mat depth_of(const Se3& there_from_camera) const {
    cv::Mat depth(480, 640, CV_32FC1);
    const Se3 back = there_from_camera.inverse();
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        const Eigen::Vector3d ray = camera_.unproject({double(x), double(y)}, 1.0);
        const double slope = (back.rotation * ray).z();
        depth.at<float>(y, x) = static_cast<float>((2.0 - back.translation.z()) / slope);
      }
    }
    return depth;
  }
  /// Where the rolling shutter sees a point: in the row that is read when the point is in it.
  cv::Point2f seen(const Eigen::Vector3d& point) const {
    Eigen::Vector2d pixel = camera_.project(point);
    for (int i = 0; i < 20; ++i) {
      pixel = camera_.project(Se3::exp(row_delay(camera_, pixel.y()) * velocity_) * point);
    }
    return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  }
  /// Largest distance of a landmark from its point, metres.
  double worst() const {
    double most = 0.0;
    for (int l = 0; l < 99; ++l) {
      const auto point = static_cast<std::size_t>(l < 3 ? l : l + 1);  // one is not static
      most = std::max(most, (map_->landmark(l).position - points_[point]).norm());
    }
    return most;
  }

  Camera camera_;
  Vector6d velocity_;
  std::unique_ptr<Map> map_;
  RgbdFrame image_;
  OrbFeatures orb_;
  std::vector<Eigen::Vector3d> points_;
  Frame frame_, next_;
};

TEST_F(TurningStart, IsCorrectedOnceTheMotionIsKnown) {
  StartKeyframe start(*map_);
  EXPECT_FALSE(start.waits_for(next_));
  EXPECT_GT(worst(), 0.03);
  start.remember(frame_, orb_, image_);
  ASSERT_TRUE(start.waits_for(next_));
  start.correct(next_, Se3::exp(interval * velocity_));
  EXPECT_LT(worst(), 0.003);
  EXPECT_EQ(map_->keyframe(0).features.size(), 99);
  EXPECT_FALSE(start.waits_for(next_)) << "once";
}

TEST_F(TurningStart, OnlyTheNextFrameTellsTheMotion) {
  StartKeyframe start(*map_);
  start.remember(frame_, orb_, image_);
  Frame later = next_;
  later.index = 9;
  EXPECT_FALSE(start.waits_for(later));
  later = next_;
  later.timestamp += 1.0;
  EXPECT_FALSE(start.waits_for(later));
  EXPECT_TRUE(start.waits_for(next_));
}

TEST_F(TurningStart, WhatOtherKeyframesMadeStays) {
  StartKeyframe start(*map_);
  start.remember(frame_, orb_, image_);
  map_->landmark(5).first_keyframe = 1;
  const Eigen::Vector3d before = map_->landmark(5).position;
  start.correct(next_, Se3::exp(interval * velocity_));
  EXPECT_EQ(map_->landmark(5).position, before);
}

}  // namespace
}  // namespace dkp_slam

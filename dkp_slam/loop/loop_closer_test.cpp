#include "dkp_slam/loop/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "dkp_slam/evaluation/absolute_error.h"

namespace dkp_slam {
namespace {

/// A round room with points on its wall, and a camera that looks outward and goes round. It sees
/// without error but misjudges each of its steps, always alike; and what it has lost from view it
/// does not know again.
class RoundTrip {
 public:
  static constexpr int steps_around = 72;

  RoundTrip() {
    camera_.fx = camera_.fy = 500.0;
    camera_.cx = 319.5;
    camera_.cy = 239.5;
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 2500; ++i) {
      const double angle = M_PI * unit(random_), radius = 4.0 + 0.5 * unit(random_);
      points_.emplace_back(radius * std::sin(angle), unit(random_), radius * std::cos(angle));
      looks_.push_back({random_(), random_(), random_(), random_()});
    }
    map = Map(camera_, 1.2F, 8);
  }

  explicit RoundTrip(int frames_per_step, const LoopCloserOptions& options = {},
                     bool realtime = false)
      : RoundTrip() {
    frames_per_step_ = frames_per_step;
    closer.emplace(options, realtime);
  }

  /// Goes one step and makes it a keyframe; closes a loop if it may and there is one. Returned is
  /// one that came to its end in this step.
  std::optional<ClosedLoop> step(bool close) {
    const int index = map.keyframe_ids();
    const Se3 truth = true_pose(index);
    Keyframe k;
    k.frame_index = index;
    k.timestamp = index;
    if (index > 0) {
      Vector6d error;
      error << 0.0, 0.005, 0.0, 0.0, 0.002, 0.0;
      k.camera_from_world = Se3::exp(error) * truth * true_pose(index - 1).inverse() *
                            map.keyframe(index - 1).camera_from_world;
    } else {
      k.camera_from_world = truth;
    }
    std::vector<int> point_of;
    k.features = features_at(truth, point_of);
    std::map<int, int> in_view;  // landmarks by point
    for (const int p : point_of) {
      const auto known = landmark_of_.find(p);
      k.landmarks.push_back(known == landmark_of_.end() ? -1 : map.resolve(known->second));
    }
    const int id = map.add_keyframe(std::move(k));
    for (std::size_t f = 0; f < point_of.size(); ++f) {
      int landmark = map.keyframe(id).landmarks[f];
      const Keyframe& added = map.keyframe(id);
      if (landmark < 0) {
        landmark = map.add_landmark(
            added.camera_from_world.inverse() * (truth * points_[std::size_t(point_of[f])]), id,
            static_cast<int>(f));
      }
      in_view[point_of[f]] = landmark;
    }
    landmark_of_ = in_view;
    map.update_covisibility(id);
    places.add_keyframe(map, id);
    std::optional<ClosedLoop> closed;
    if (close) closer->add_keyframe(id);
    for (int i = 0; i < frames_per_step_; ++i) {
      if (const auto ended = frame()) closed = ended;
    }
    return closed;
  }
  /// A frame that is no keyframe.
  std::optional<ClosedLoop> frame() {
    ++frame_index_;
    if (!closer->due(frame_index_)) return closer->advance(map, places, {}, frame_index_);
    closer->carry_out(map);
    return std::nullopt;
  }

  /// RMSE of the keyframes' positions after alignment, metres.
  double error() const {
    Trajectory truth, path;
    for (int k = 0; k < map.keyframe_ids(); ++k) {
      truth.push_back({double(k), true_pose(k).inverse()});
      path.push_back({double(k), map.keyframe(k).camera_from_world.inverse()});
    }
    return absolute_error(truth, path).statistics.rmse;
  }
  /// Both halves of the wall look alike all along, but their points do not lie alike.
  void repeat_looks() {
    std::vector<std::size_t> order(points_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto angle = [&](std::size_t i) { return std::atan2(points_[i].x(), points_[i].z()); };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
    const std::size_t half = order.size() / 2;
    for (std::size_t i = 0; i < half; ++i) looks_[order[i + half]] = looks_[order[i]];
  }

  Map map{Camera(), 1.2F, 8};
  PlaceIndex places;
  std::optional<LoopCloser> closer{std::in_place};

 private:
  static Se3 true_pose(int index) {
    const double angle = 2.0 * M_PI * index / steps_around;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    return Se3(turn, {std::sin(angle), 0.0, std::cos(angle)}).inverse();
  }
  FrameFeatures features_at(const Se3& camera_from_world, std::vector<int>& point_of) const {
    OrbFeatures orb;
    std::vector<float> depths;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d p = camera_from_world * points_[i];
      if (p.z() < 0.5) continue;
      const Eigen::Vector2d pixel = camera_.project(p);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= 639 || pixel.y() >= 479) continue;
      orb.keypoints.emplace_back(float(pixel.x()), float(pixel.y()), 31.0F, 0.0F, 1.0F, 0);
      orb.descriptors.push_back(looks_[i]);
      depths.push_back(float(p.z()));
      point_of.push_back(static_cast<int>(i));
    }
    FrameFeatures features(orb, cv::Mat::zeros(480, 640, CV_32F), camera_);
    features.depth = depths;
    return features;
  }

  Camera camera_;
  int frames_per_step_ = 60;
  int frame_index_ = 0;
  std::mt19937_64 random_{17};
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> looks_;
  std::map<int, int> landmark_of_;  // by point, of what the last keyframe sees
};

TEST(LoopCloserTest, AClosedLoopTakesFourFifthsOfTheErrorAway) {
  RoundTrip open, closed;
  std::optional<ClosedLoop> loop;
  for (int i = 0; i < RoundTrip::steps_around + 5 && !loop; ++i) {
    open.step(false);
    loop = closed.step(true);
  }
  ASSERT_TRUE(loop);
  EXPECT_GT(loop->keyframe, 60);
  EXPECT_LT(loop->old_keyframe, 10);
  EXPECT_GT(loop->moved, 0.2);
  EXPECT_GT(open.error(), 0.05);
  EXPECT_LT(closed.error(), open.error() / 5.0) << closed.error() << " " << open.error();
  EXPECT_EQ(closed.closer->closed().size(), 1U);
  // The two ends of the loop see the same landmarks now.
  EXPECT_TRUE(closed.map.keyframe(loop->keyframe).covisible.contains(loop->old_keyframe));
  EXPECT_LT(closed.map.live_landmarks(), open.map.live_landmarks());
}

TEST(LoopCloserTest, NoLoopBeforeTheCameraIsBack) {
  RoundTrip trip;
  for (int i = 0; i < 55; ++i) EXPECT_FALSE(trip.step(true));
}

TEST(LoopCloserTest, LooksAloneCloseNoLoop) {
  RoundTrip trip;
  trip.repeat_looks();
  LoopDetector detector;
  bool suspected = false;
  for (int i = 0; i < 55; ++i) {
    EXPECT_FALSE(trip.step(true));
    detector.look_at(i);
    std::optional<std::vector<int>> found;
    while (!found) found = detector.advance(trip.map, trip.places);
    suspected |= !found->empty();
  }
  EXPECT_TRUE(suspected);
}

TEST(LoopCloserTest, RepeatsExactly) {
  RoundTrip first, second;
  for (int i = 0; i < RoundTrip::steps_around; ++i) {
    first.step(true);
    second.step(true);
  }
  EXPECT_EQ(first.closer->closed().size(), 1U);
  EXPECT_EQ(first.error(), second.error());
}

}  // namespace
}  // namespace dkp_slam

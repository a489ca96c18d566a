#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam::testing {

/// A tracker in a map of points that it sees without any error.
struct Tracking : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;
  TrackerOptions options;
  bool localize_only = false;
  bool fill_index = true;  // else no place is recognised
  std::optional<Tracker> made_;

  /// Made at the first call, with the options as they are then.
  Tracker& tracker() {
    if (!made_) made_.emplace(map, places, MeasurementModel(), options, localize_only);
    return *made_;
  }

  Frame frame_at(const Se3& camera_from_world, int index) {
    Frame frame = world.frame_at(camera_from_world, points_);
    frame.camera_from_world = Se3();  // to be found out
    frame.index = index;
    frame.timestamp = index / 30.0;
    return frame;
  }
  TrackingResult track(Frame& frame, bool adjusting = false) {
    const TrackingResult result = tracker().track(frame, adjusting);
    if (result.keyframe_due) {
      world.add_keyframe(map, frame, points_);
      if (fill_index) places.add_keyframe(map, frame.reference_keyframe);
    }
    if (result.localised) tracker().settle(frame, result.keyframe_due);
    return result;
  }
  /// Where a camera is that moves steadily to the side.
  static Se3 steady(int index) { return pose(0.01 * index, 0.0, 0.0); }
  /// Tracks frames [from, to) of the steady camera, all of which must be localised.
  void follow(int from, int to) {
    for (int i = from; i < to; ++i) {
      Frame frame = frame_at(steady(i), i);
      ASSERT_TRUE(track(frame).localised) << i;
    }
  }
  /// A frame of the steady camera before which somebody stands: nothing static is seen, and the
  /// camera's motion is measured.
  Frame covered(int index) {
    Frame frame = frame_at(steady(index), index);
    forget_points(frame, frame.features.size());
    std::fill(frame.is_static.begin(), frame.is_static.end(), 0);
    frame.current_from_previous = steady(index) * steady(index - 1).inverse();
    return frame;
  }
  /// Leaves only so many of the frame's features static.
  static void keep_static(Frame& frame, int count) {
    for (std::size_t f = 0; f < frame.is_static.size(); ++f) {
      frame.is_static[f] = static_cast<int>(f) < count;
    }
  }
  /// Takes their landmark from so many features' points: as if the room there were new.
  /// The frame then tracks fewer landmarks of the map.
  void forget_points(Frame& frame, int count) {
    for (int f = 0; f < count; ++f) {
      frame.features.descriptor[static_cast<std::size_t>(f)] = world.random_descriptor();
    }
  }
  /// The feature of the frame made last that shows the point; -1 for none.
  int feature_of(int point) const {
    const auto found = std::find(points_.begin(), points_.end(), point);
    return found == points_.end() ? -1 : static_cast<int>(found - points_.begin());
  }
  std::vector<int> points_;  // of each feature of the frame made last
};

}  // namespace dkp_slam::testing

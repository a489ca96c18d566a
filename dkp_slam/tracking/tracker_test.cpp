#include "dkp_slam/tracking/tracker.h"

#include <set>

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

/// A tracker in a map of points that it sees without any error.
struct Tracking : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;
  Tracker tracker{map, places, MeasurementModel(), TrackerOptions()};

  Frame frame_at(const Se3& camera_from_world, int index) {
    Frame frame = world.frame_at(camera_from_world, points_);
    frame.camera_from_world = Se3();  // to be found out
    frame.index = index;
    frame.timestamp = index / 30.0;
    return frame;
  }
  TrackingResult track(Frame& frame) {
    const TrackingResult result = tracker.track(frame, false);
    if (result.keyframe_due) {
      world.add_keyframe(map, frame, points_);
      places.add_keyframe(map, frame.reference_keyframe);
    }
    if (result.localised) tracker.settle(frame, result.keyframe_due);
    return result;
  }
  /// The feature of the frame made last that shows the point; -1 for none.
  int feature_of(int point) const {
    const auto found = std::find(points_.begin(), points_.end(), point);
    return found == points_.end() ? -1 : static_cast<int>(found - points_.begin());
  }
  std::vector<int> points_;  // of each feature of the frame made last
};

void expect_each_landmark_once(const Map& map, const Frame& frame) {
  std::set<int> seen;
  for (const int id : frame.landmark) {
    if (id < 0) continue;
    EXPECT_TRUE(map.has_landmark(id));
    EXPECT_TRUE(seen.insert(id).second) << "landmark " << id << " belongs to two features";
  }
}

TEST_F(Tracking, FollowsAMovingCamera) {
  for (int i = 0; i < 10; ++i) {
    const Se3 truth = pose(0.01 * i, 0.0, 0.0, 0.004 * i);
    Frame frame = frame_at(truth, i);
    ASSERT_TRUE(track(frame).localised);
    EXPECT_LT(pose_distance(frame.camera_from_world, truth), 1e-3);
    EXPECT_GT(tracker.tracked_landmarks(), 100);
  }
}

// The first feature's evidence removes the landmark, and the second one's was read from it.
TEST_F(Tracking, ALandmarkThatEvidenceRemovesIsReadByNobodyAfter) {
  // Two points whose pixels are just under the bound of an inlier apart.
  const MeasurementModel model;
  const double bound = std::sqrt(model.pixel_chi2) * model.pixel_sigma;
  world.points[1] = world.points[0];
  world.points[1].x() += 1.02 * bound * world.points[0].z() / world.camera.fx;
  Frame first = frame_at({}, 0);
  ASSERT_TRUE(track(first).keyframe_due);
  const int a = feature_of(0), b = feature_of(1);
  ASSERT_GE(a, 0);
  ASSERT_GE(b, 0);
  const int kept = first.landmark[static_cast<std::size_t>(b)];
  // Only a few landmarks are followed from frame to frame, so that the odd one out pulls the pose
  // its way; the local map then puts it right, and the odd match is found out.
  Frame second = frame_at({}, 1);
  for (int f = 0; f < second.features.size(); ++f) {
    if (f != a && f != b && f % 14 != 0) second.is_static[static_cast<std::size_t>(f)] = 0;
  }
  ASSERT_TRUE(track(second).localised);
  map.fuse_landmarks(second.landmark[static_cast<std::size_t>(a)], kept);
  map.landmark(kept).dynamic_log_odds = TrackerOptions().belief.dynamic_above;
  Frame third = frame_at({}, 2);
  EXPECT_TRUE(track(third).localised);
  expect_each_landmark_once(map, third);
}

}  // namespace
}  // namespace dkp_slam

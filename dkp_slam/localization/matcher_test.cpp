#include "dkp_slam/localization/matcher.h"

#include <numeric>

#include <gtest/gtest.h>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/localization/test_world.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;

/// A map with one keyframe at the origin, which is also the last frame; the current frame has
/// moved.
struct Matcher : ::testing::Test {
  PointWorld world{250};
  Map map{world.camera, 1.2F, 8};
  Se3 moved = pose(0.03, -0.02, 0.01, 0.02);
  std::vector<int> last_points, points;
  Frame last = world.frame_at({}, last_points), frame = world.frame_at(moved, points);

  Matcher() { world.add_keyframe(map, last, last_points); }

  /// Which point a landmark stands for: they were made in the order of the last frame's features.
  int point_of_landmark(int landmark) const { return last_points[std::size_t(landmark)]; }
  int feature_of_point(int point) const {
    return int(std::find(points.begin(), points.end(), point) - points.begin());
  }
  std::size_t in_both() const {
    return std::size_t(std::count_if(points.begin(), points.end(), [&](int p) {
      return std::find(last_points.begin(), last_points.end(), p) != last_points.end();
    }));
  }
  std::vector<int> all_landmarks() const {
    std::vector<int> ids(std::size_t(map.landmark_ids()));
    std::iota(ids.begin(), ids.end(), 0);
    return ids;
  }
};

TEST_F(Matcher, LastFramesLandmarksAreFoundNearWhereAGuessPutsThem) {
  frame.camera_from_world = moved * pose(0.01, 0.0, 0.0);  // 2 to 3 pixels off
  const auto matches = match_last_frame(map, last, frame, 8.0F);
  EXPECT_EQ(matches.size(), in_both());
  for (const FrameMatch& m : matches) {
    EXPECT_EQ(points[std::size_t(m.feature)], point_of_landmark(m.landmark));
    EXPECT_EQ(m.position, map.landmark(m.landmark).position);
    EXPECT_EQ(m.distance, 0);
  }
  // Out of reach where the guess is worse than the radius.
  frame.camera_from_world = moved * pose(0.2, 0.0, 0.0);
  EXPECT_TRUE(match_last_frame(map, last, frame, 8.0F).empty());
}

TEST_F(Matcher, PointsWithDepthThatAreNoLandmarksMatchToo) {
  std::fill(last.landmark.begin(), last.landmark.end(), -1);
  last.features.depth[3] = 0.0F;  // this one cannot
  const auto matches = match_last_frame(map, last, frame, 8.0F);
  EXPECT_EQ(matches.size(), in_both() - 1);
  for (const FrameMatch& m : matches) {
    EXPECT_EQ(m.landmark, -1);
    const Eigen::Vector3d truth = world.points[std::size_t(points[std::size_t(m.feature)])];
    EXPECT_LT((m.position - truth).norm(), 1e-5);  // pixels and depths are floats
  }
}

TEST_F(Matcher, DynamicFeaturesOfEitherFrameDoNotMatch) {
  for (std::size_t i = 0; i < 40; ++i) last.is_static[i] = 0;
  for (std::size_t i = frame.is_static.size() - 40; i < frame.is_static.size(); ++i) {
    frame.is_static[i] = 0;
  }
  for (const FrameMatch& m : match_last_frame(map, last, frame, 8.0F)) {
    EXPECT_TRUE(frame.is_static[std::size_t(m.feature)]);
    EXPECT_GE(m.landmark, 40);
  }
}

TEST_F(Matcher, MatchesThatTurnAgainstTheOthersAreDropped) {
  // A histogram's three best bins stay if they hold a tenth of the best: six of 250 do not.
  std::vector<int> turned = {5, 17, 33, 80, 121, 150};
  for (const int f : turned) frame.features.angle[std::size_t(f)] = 90.0F;
  const auto matches = match_last_frame(map, last, frame, 8.0F);
  EXPECT_EQ(matches.size(), in_both() - turned.size());
  for (const FrameMatch& m : matches) EXPECT_EQ(frame.features.angle[std::size_t(m.feature)], 0.0F);
}

TEST_F(Matcher, ViewHoldsWhatTheImageAndTheScalesAllow) {
  const auto visible = landmarks_in_view(map, frame, all_landmarks());
  EXPECT_NEAR(double(visible.size()), double(in_both()), 3.0);  // border pixels
  for (const VisibleLandmark& v : visible) {
    const Eigen::Vector3d p = moved * map.landmark(v.landmark).position;
    EXPECT_LT((v.pixel - world.camera.project(p)).norm(), 1e-9);
    EXPECT_NEAR(v.depth, p.z(), 1e-12);
  }
  frame.camera_from_world = pose(0.0, 0.0, -5.0);  // five metres ahead: all behind the camera
  EXPECT_TRUE(landmarks_in_view(map, frame, all_landmarks()).empty());
  frame.camera_from_world = pose(0.0, 0.0, 8.0);  // eight metres back: too small for level 0
  EXPECT_TRUE(landmarks_in_view(map, frame, all_landmarks()).empty());
  // From the other side: in the image, but their look is unknown from there.
  frame.camera_from_world = pose(0.0, 0.0, 2.0) * pose(0, 0, 0, M_PI) * pose(0.0, 0.0, -2.0);
  EXPECT_TRUE(landmarks_in_view(map, frame, all_landmarks()).empty());
}

TEST_F(Matcher, VisibleLandmarksMatchFreeFeaturesOfTheRightDepth) {
  const int taken = feature_of_point(last_points[10]),
            elsewhere = feature_of_point(last_points[20]);
  ASSERT_LT(std::size_t(std::max(taken, elsewhere)), points.size());
  frame.landmark[std::size_t(taken)] = 99;
  frame.features.depth[std::size_t(elsewhere)] += 1.0F;
  frame.is_static[std::size_t(feature_of_point(last_points[30]))] = 0;  // the tracker decides on it
  const auto visible = landmarks_in_view(map, frame, all_landmarks());
  const auto matches = match_visible(map, frame, visible, 1.0F);
  EXPECT_EQ(matches.size(), visible.size() - 2);
  bool dynamic_matched = false;
  for (const FrameMatch& m : matches) {
    EXPECT_EQ(points[std::size_t(m.feature)], point_of_landmark(m.landmark));
    EXPECT_NE(m.feature, taken);
    EXPECT_NE(m.feature, elsewhere);
    dynamic_matched |= !frame.is_static[std::size_t(m.feature)];
  }
  EXPECT_TRUE(dynamic_matched);
}

TEST_F(Matcher, KeyframesMatchByDescriptorFromAnywhere) {
  std::vector<int> far_points;
  Frame far = world.frame_at(pose(0.3, 0.2, -0.4, 0.3), far_points);
  far.camera_from_world = Se3();  // not asked
  far.features.descriptor[7] = world.random_descriptor();
  far.is_static[9] = 0;
  const auto matches = match_keyframe(map, map.keyframe(0), far);
  EXPECT_GT(matches.size(), 60U);
  for (const FrameMatch& m : matches) {
    EXPECT_EQ(far_points[std::size_t(m.feature)], point_of_landmark(m.landmark));
    EXPECT_NE(m.feature, 7);
    EXPECT_NE(m.feature, 9);
  }
}

TEST_F(Matcher, RefinementFindsThePoseAndThrowsOutWhatIsWrong) {
  frame.camera_from_world = moved * pose(0.01, 0.0, 0.0);
  auto matches = match_last_frame(map, last, frame, 8.0F);
  const std::size_t right = matches.size() - 20;
  for (std::size_t i = right; i < matches.size(); ++i) matches[i].position.x() += 0.3;
  EXPECT_EQ(refine_pose(map, {}, frame, matches), int(right));
  EXPECT_EQ(matches.size(), right);
  EXPECT_LT(testing::pose_distance(frame.camera_from_world, moved), 1e-4);
}

}  // namespace
}  // namespace dkp_slam

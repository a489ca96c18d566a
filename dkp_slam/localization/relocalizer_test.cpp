#include "dkp_slam/localization/relocalizer.h"

#include <gtest/gtest.h>

#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/map/map_snapshot.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;
using testing::pose;
using testing::pose_distance;

/// Two rooms back to back, a keyframe in each.
struct Relocalizer : ::testing::Test {
  PointWorld world{300};
  Map map{world.camera, 1.2F, 8};
  PlaceIndex places;
  Se3 other_room = pose(0.0, 0.0, 0.0, M_PI);
  std::vector<int> points;

  Relocalizer() {
    const std::size_t first = world.points.size();
    for (std::size_t i = 0; i < first; ++i) {
      world.points.push_back(other_room.inverse() * world.points[i]);
      world.descriptors.push_back(world.random_descriptor());
    }
    for (const Se3& camera_from_world : {Se3(), other_room}) {
      Frame keyframe = world.frame_at(camera_from_world, points);
      places.add_keyframe(map, world.add_keyframe(map, keyframe, points));
    }
  }
  /// A frame at this pose that does not know it.
  Frame lost_at(const Se3& camera_from_world) {
    Frame frame = world.frame_at(camera_from_world, points);
    frame.camera_from_world = pose(9.0, 9.0, 9.0);
    return frame;
  }
};

TEST_F(Relocalizer, FindsThePoseInTheRightRoom) {
  for (int room = 0; room < 2; ++room) {
    const Se3 truth = pose(0.25, -0.1, 0.3, 0.2) * (room == 0 ? Se3() : other_room);
    Frame frame = lost_at(truth);
    ASSERT_TRUE(relocalize(map, places, {}, 1, frame));
    EXPECT_LT(pose_distance(frame.camera_from_world, truth), 1e-4);
    EXPECT_EQ(frame.reference_keyframe, room);
    EXPECT_GT(frame.tracked_landmarks(), 100);
    for (std::size_t f = 0; f < points.size(); ++f) {
      if (frame.landmark[f] < 0) continue;
      const Eigen::Vector3d place = map.landmark(frame.landmark[f]).position;
      EXPECT_EQ(place, world.points[std::size_t(points[f])]);
    }
  }
}

TEST_F(Relocalizer, ToleratesManyWrongMatches) {
  const Se3 truth = pose(0.1, 0.1, 0.1, 0.1);
  Frame frame = lost_at(truth);
  // A third of the features look like another one.
  const std::vector<Descriptor> right = frame.features.descriptor;
  for (std::size_t f = 0; f < right.size(); f += 3) {
    frame.features.descriptor[f] = right[(f + 30) % right.size()];
  }
  ASSERT_TRUE(relocalize(map, places, {}, 1, frame));
  EXPECT_LT(pose_distance(frame.camera_from_world, truth), 1e-3);
}

TEST_F(Relocalizer, RepeatsExactly) {
  const std::vector<Descriptor> descriptors = world.descriptors;
  std::vector<Se3> found;
  for (int i = 0; i < 2; ++i) {
    Frame frame = lost_at(pose(0.1, 0.1, 0.1, 0.1));
    for (std::size_t f = 0; f < points.size(); f += 2) {
      frame.features.descriptor[f] = descriptors[(f + 30) % descriptors.size()];
      frame.features.depth[f] *= 1.01F;
    }
    ASSERT_TRUE(relocalize(map, places, {}, 7, frame));
    found.push_back(frame.camera_from_world);
  }
  EXPECT_EQ(found[0].translation, found[1].translation);
  EXPECT_EQ(found[0].rotation.coeffs(), found[1].rotation.coeffs());
}

TEST_F(Relocalizer, AnExcerptOfTheMapAlignsAsTheMapDoes) {
  for (int l = 0; l < map.landmark_ids(); l += 7) {
    if (map.has_landmark(l)) map.remove_landmark(l);
  }
  const Se3 truth = pose(0.1, 0.1, 0.1, 0.1) * other_room;
  Frame whole = lost_at(truth), part = lost_at(truth);
  const std::vector<FrameMatch> matches = align_to_keyframe(map, {}, 3, 1, whole);
  Excerpt excerpt = excerpt_of(map, 1);
  ASSERT_EQ(excerpt.parts.check(), std::nullopt);
  const std::vector<FrameMatch> same =
      align_to_keyframe(Map(std::move(excerpt.parts)), {}, 3, 0, part);
  ASSERT_GT(matches.size(), 100U);
  ASSERT_EQ(same.size(), matches.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    EXPECT_EQ(same[i].feature, matches[i].feature);
    EXPECT_EQ(excerpt.landmarks[std::size_t(same[i].landmark)], matches[i].landmark);
  }
  EXPECT_EQ(part.camera_from_world.translation, whole.camera_from_world.translation);
  EXPECT_LT(pose_distance(whole.camera_from_world, truth), 1e-3);
}

TEST_F(Relocalizer, DoesNotRestOnWhatIsNewInAMapThatIsNot) {
  const auto keep_found = [&](int keyframe, int frames) {
    for (const int l : map.keyframe(keyframe).landmarks) {
      if (l >= 0) map.landmark(l).found = frames;
    }
  };
  const auto finds = [&](const Se3& camera_from_world) {
    Frame frame = lost_at(camera_from_world);
    return relocalize(map, places, {}, 1, frame);
  };
  // As of somebody whose landmarks hide those of the room.
  keep_found(0, 20);
  keep_found(1, 1);
  EXPECT_TRUE(finds({}));
  EXPECT_FALSE(finds(other_room));
  // A seventh that has been there before is enough...
  int kept = 0;
  for (const int l : map.keyframe(1).landmarks) {
    if (l >= 0 && kept++ % 7 == 0) map.landmark(l).found = 20;
  }
  EXPECT_TRUE(finds(other_room));
  // ... and in a map where nothing has lasted yet nothing is asked for.
  keep_found(0, 1);
  keep_found(1, 1);
  EXPECT_TRUE(finds(other_room));
}

TEST_F(Relocalizer, DoesNotRecogniseAnUnknownPlace) {
  Frame frame = lost_at({});
  for (Descriptor& d : frame.features.descriptor) d = world.random_descriptor();
  EXPECT_FALSE(relocalize(map, places, {}, 1, frame));
  EXPECT_EQ(frame.tracked_landmarks(), 0);
  // Nor a place from 20 features, nor one where everything that matches is called dynamic.
  frame = lost_at({});
  for (std::size_t f = 20; f < points.size(); ++f) {
    frame.features.descriptor[f] = world.random_descriptor();
  }
  EXPECT_FALSE(relocalize(map, places, {}, 1, frame));
  frame = lost_at({});
  std::fill(frame.is_static.begin(), frame.is_static.end(), 0);
  EXPECT_FALSE(relocalize(map, places, {}, 1, frame));
}

TEST_F(Relocalizer, AnEmptyMapHasNoPlace) {
  Frame frame = lost_at({});
  const Map empty(world.camera, 1.2F, 8);
  EXPECT_FALSE(relocalize(empty, PlaceIndex(), {}, 1, frame));
}

}  // namespace
}  // namespace dkp_slam

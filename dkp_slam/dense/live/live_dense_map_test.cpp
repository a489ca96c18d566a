#include "dkp_slam/dense/live/live_dense_map.h"

#include <algorithm>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/error.h"
#include "dkp_slam/system/slam.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

using testing::Recording;
using testing::seen;
using testing::small_camera;
using testing::swaying;

/// Tells an observer of keyframes of a wall, as the system would.
class Teller {
 public:
  explicit Teller(LiveDenseMap& dense) : dense_(dense) {}

  /// The keyframe is that of a wall `depth` metres ahead.
  void keyframe(int id, double depth, const cv::Mat& mask = {}) {
    auto snapshot = std::make_shared<FrameSnapshot>();
    snapshot->frame = seen(small_camera(), testing::wall(depth), swaying(id));
    snapshot->frame.index = snapshot->result.index = 10 * id;
    snapshot->frame.timestamp = snapshot->result.timestamp = id;
    snapshot->result.keyframe = snapshot->result.localised = true;
    snapshot->dynamics.mask = mask;
    dense_.on_frame(snapshot);
    KeyframeSnapshot keyframe;
    keyframe.id = id;
    keyframe.frame_index = 10 * id;
    dense_.on_keyframe(keyframe);
  }
  /// Keyframes `first` to `last` lie in `map`, `ahead` metres before where they were taken.
  void move(int first, int last, int map, double ahead) {
    MapChange change;
    for (int id = first; id <= last; ++id) {
      KeyframeState state;
      state.id = id;
      state.map = map;
      const Se3 moved({1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, ahead});
      state.camera_from_world = (moved * swaying(id)).inverse();
      change.keyframes.push_back(state);
    }
    dense_.on_map(change);
  }
  void remove(int id) {
    MapChange change;
    change.removed_keyframes = {id};
    dense_.on_map(change);
  }

 private:
  LiveDenseMap& dense_;
};

/// Where the wall is found in a map; 0 where there is none.
double wall_in(LiveDenseMap& dense, int map) {
  double sum = 0.0;
  std::size_t count = 0;
  dense.look(map, [&](const KeyframeFusion& fused) {
    SurfaceOptions options;
    options.least_views = 1.0;
    const SurfaceMesh mesh = extract_surface(fused.map(), options);
    for (const auto& v : mesh.vertices) sum += v.z();
    count = mesh.vertices.size();
  });
  return count > 0 ? sum / double(count) : 0.0;
}

int keyframes_in(LiveDenseMap& dense, int map) {
  int count = 0;
  dense.look(map, [&](const KeyframeFusion& fused) { count = int(fused.path().size()); });
  return count;
}

TEST(LiveDenseMap, FollowsKeyframesThatMoveAndMapsThatMerge) {
  LiveDenseMap dense(small_camera(), {});
  EXPECT_EQ(dense.largest_map(), 0);
  EXPECT_FALSE(dense.look(0, [](const KeyframeFusion&) {}));
  Teller tell(dense);
  for (int id = 0; id < 3; ++id) tell.keyframe(id, 2.0);
  tell.move(0, 2, 0, 0.0);
  for (int id = 3; id < 8; ++id) tell.keyframe(id, 2.0);
  tell.move(3, 7, 1, 0.5);
  tell.move(20, 25, 1, 0.0);  // of a stored map: nobody has their images
  dense.finish();
  EXPECT_NEAR(wall_in(dense, 0), 2.0, 0.01);
  EXPECT_NEAR(wall_in(dense, 1), 2.5, 0.01);
  EXPECT_EQ(dense.largest_map(), 1);
  EXPECT_EQ(keyframes_in(dense, 1), 5);
  tell.move(3, 7, 0, 0.0);
  tell.remove(4);
  dense.finish();
  EXPECT_NEAR(wall_in(dense, 0), 2.0, 0.01);
  EXPECT_EQ(keyframes_in(dense, 0), 7);
  EXPECT_FALSE(dense.look(1, [](const KeyframeFusion&) {}));
  EXPECT_EQ(dense.largest_map(), 0);
}

TEST(LiveDenseMap, TheImagesHaveABound) {
  LiveDenseOptions options;
  options.keyframes = 8;
  LiveDenseMap dense(small_camera(), options);
  Teller tell(dense);
  for (int id = 0; id < 40; ++id) tell.keyframe(id, 2.0);
  tell.move(0, 39, 0, 0.0);
  dense.finish();
  EXPECT_LE(keyframes_in(dense, 0), 8);
  EXPECT_GE(keyframes_in(dense, 0), 6);
  double first = 0.0, last = 0.0;
  dense.look(0, [&](const KeyframeFusion& fused) {
    first = fused.path().front().timestamp;
    last = fused.path().back().timestamp;
  });
  EXPECT_LT(first, 20.0) << "what is long ago stays, too";
  EXPECT_EQ(last, 39.0);
}

TEST(LiveDenseMap, WhatTheRunMaskedIsLeftOut) {
  LiveDenseMap dense(small_camera(), {});
  Teller tell(dense);
  cv::Mat left = cv::Mat::zeros(small_camera().height, small_camera().width, CV_8UC1);
  left(cv::Rect(0, 0, 80, left.rows)) = 255;
  for (int id = 0; id < 4; ++id) tell.keyframe(id, 2.0, left);
  tell.move(0, 3, 0, 0.0);
  dense.finish();
  dense.look(0, [&](const KeyframeFusion& fused) {
    const auto mesh = extract_surface(fused.map(), {.least_views = 1.0});
    EXPECT_GT(mesh.vertices.size(), 500U);
    // The camera sways by 15 cm, and turns by 4 degrees.
    for (const auto& v : mesh.vertices) EXPECT_GT(v.x(), -0.35F);
  });
}

TEST(LiveDenseMap, MayWaitUntilSomebodyLooks) {
  LiveDenseOptions options;
  options.at_once = false;
  options.live = true;
  LiveDenseMap dense(small_camera(), options);
  Teller tell(dense);
  for (int id = 0; id < 4; ++id) tell.keyframe(id, 2.0);
  tell.move(0, 3, 0, 0.0);
  EXPECT_EQ(dense.version(), 0);
  dense.look(0, [](const KeyframeFusion&) {});
  dense.finish();
  EXPECT_GT(dense.version(), 0);
  EXPECT_NEAR(wall_in(dense, 0), 2.0, 0.01);
}

TEST(LiveDenseMap, RefusesWhatMakesNoSense) {
  LiveDenseOptions options;
  options.keyframes = 1;
  EXPECT_THROW(LiveDenseMap(small_camera(), options), Error);
  options.keyframes = 10;
  options.fusion.map.voxel = 1.0;
  EXPECT_THROW(LiveDenseMap(small_camera(), options), Error);
}

const Recording& walkers() {
  static const Recording made("walking_xyz", 60, 90, 2);
  return made;
}

struct Surface {
  SurfaceMesh mesh;
  Trajectory path;
};

/// What a run past people, whose true masks it is given, leaves.
Surface surface_of_run() {
  SlamConfig config;
  config.camera = walkers().camera;
  config.dynamics.mode = DynamicsMode::masks;
  LiveDenseOptions options;
  options.fusion.map.voxel = 0.04;
  auto dense = std::make_shared<LiveDenseMap>(config.camera, options);
  Slam slam(config);
  slam.add_observer(dense, LiveDenseMap::watching(0.5));
  for (std::size_t i = 0; i < walkers().frames.size(); ++i) {
    RgbdFrame frame = walkers().frames[i];
    frame.mask = walkers().truths[i].mask;
    slam.feed(std::move(frame));
  }
  slam.finish();
  dense->finish();
  Surface surface;
  SurfaceOptions extraction;
  extraction.least_views = 1.0;
  EXPECT_TRUE(dense->look(dense->largest_map(), [&](const KeyframeFusion& fused) {
    surface = {extract_surface(fused.map(), extraction), fused.path()};
  }));
  return surface;
}

TEST(LiveDenseMap, ARunOfflineGivesTheSameTwice) {
  const Surface one = surface_of_run(), two = surface_of_run();
  EXPECT_GT(one.mesh.vertices.size(), 1000U);
  EXPECT_GT(one.path.size(), 2U);
  EXPECT_EQ(one.mesh.triangles, two.mesh.triangles);
  EXPECT_EQ(one.mesh.colours, two.mesh.colours);
  ASSERT_EQ(one.mesh.vertices.size(), two.mesh.vertices.size());
  for (std::size_t i = 0; i < one.mesh.vertices.size(); ++i) {
    ASSERT_EQ(one.mesh.vertices[i], two.mesh.vertices[i]);
  }
}

}  // namespace
}  // namespace dkp_slam

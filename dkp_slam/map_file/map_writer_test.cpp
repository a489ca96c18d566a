#include "dkp_slam/map_file/map_writer.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/sqlite.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using testing::difference;
using testing::GrowingMap;
using ::testing::HasSubstr;

class Writing : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    file_ = folder_ / "room.map";
  }

  fs::path file_;
};

TEST_F(Writing, ManyUpdatesAreOneSave) {
  GrowingMap grown;
  {
    MapWriter writer(file_, grown.map);
    EXPECT_TRUE(fs::exists(file_));
    for (int i = 0; i < 80; ++i) {
      grown.step();
      if (i % 3 == 0) writer.update(grown.map);
    }
    writer.update(grown.map);
    writer.finish();
    EXPECT_FALSE(fs::exists(file_.string() + "-wal"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  const StoredMap stored = read_map(file_);
  EXPECT_EQ(difference(grown.map, stored.map), "");
  EXPECT_GT(stored.state.revision, 20);
  save_map(folder_ / "once.map", grown.map);
  EXPECT_EQ(difference(read_map(folder_ / "once.map").map, stored.map), "");
}

TEST_F(Writing, ANewFileIsAMapWithoutAnything) {
  const Map empty(testing::test_camera(), 1.2F, 8);
  { MapWriter writer(file_, empty); }
  const StoredMap stored = read_map(file_);
  EXPECT_EQ(stored.map.keyframe_ids(), 0);
  EXPECT_EQ(stored.map.maps(), 1);
  EXPECT_EQ(difference(empty, stored.map), "");
}

TEST_F(Writing, GoesOnWhereItStopped) {
  GrowingMap grown;
  for (int session = 1; session <= 4; ++session) {
    std::optional<MapFileState> state;
    if (fs::exists(file_)) state = read_map(file_).state;
    std::unique_ptr<MapWriter> writer;
    if (state) {
      writer = std::make_unique<MapWriter>(file_, *state);
    } else {
      writer = std::make_unique<MapWriter>(file_, grown.map);
    }
    grown.grow_to(12 * session);
    writer->update(grown.map);
    if (session % 2 == 0) writer->finish();
    writer.reset();  // without an end it keeps what it was given
    EXPECT_EQ(difference(grown.map, read_map(file_).map), "") << session;
  }
}

TEST_F(Writing, NothingNewWritesNothing) {
  GrowingMap grown;
  grown.grow_to(30);
  save_map(file_, grown.map);
  StoredMap stored = read_map(file_);
  MapWriter writer(file_, stored.state);
  writer.update(stored.map);
  writer.finish();
  EXPECT_EQ(read_map(file_).state.revision, stored.state.revision);
}

TEST_F(Writing, OnlyWhatChangedIsHandedOver) {
  GrowingMap grown;
  grown.grow_to(30);
  ChangeFinder finder;
  const MapChange all = finder.find(grown.map);
  EXPECT_EQ(int(all.keyframes.size()), grown.map.live_keyframes());
  EXPECT_EQ(int(all.looks.size()), grown.map.live_keyframes());
  EXPECT_EQ(int(all.landmarks.size()), grown.map.live_landmarks());
  EXPECT_TRUE(finder.find(grown.map).empty());

  const int l = grown.map.landmarks_of({29}).front();
  ++grown.map.landmark(l).found;
  MapChange change = finder.find(grown.map);
  EXPECT_TRUE(change.keyframes.empty());
  ASSERT_EQ(change.landmarks.size(), 1U);
  EXPECT_EQ(change.landmarks[0].id, l);

  grown.map.keyframe(29).camera_from_world.rotation.x() += 1e-16;
  change = finder.find(grown.map);
  ASSERT_EQ(change.keyframes.size(), 1U);
  EXPECT_TRUE(change.looks.empty());
  EXPECT_TRUE(change.landmarks.empty());

  const int seen_by = static_cast<int>(grown.map.landmark(l).sightings.size());
  grown.map.remove_landmark(l);
  change = finder.find(grown.map);
  EXPECT_EQ(int(change.keyframes.size()), seen_by);
  EXPECT_EQ(change.removed_landmarks, std::vector<int>{l});
}

TEST_F(Writing, AChildOfARemovedKeyframeGetsItsGrandparent) {
  GrowingMap grown;
  grown.grow_to(10);
  Map& map = grown.map;
  int child = 9;
  while (map.keyframe(map.keyframe(child).parent).parent < 0) --child;
  const int parent = map.keyframe(child).parent;
  ASSERT_FALSE(map.keyframe(parent).removed);
  ChangeFinder finder;
  finder.find(map);
  map.remove_keyframe(parent);
  const MapChange change = finder.find(map);
  EXPECT_EQ(change.removed_keyframes, std::vector<int>{parent});
  const auto moved = std::find_if(change.keyframes.begin(), change.keyframes.end(),
                                  [&](const KeyframeState& k) { return k.id == child; });
  ASSERT_NE(moved, change.keyframes.end());
  EXPECT_FALSE(map.keyframe(moved->parent).removed);
}

TEST_F(Writing, TheFileMustBeTheOneThatWasRead) {
  GrowingMap grown;
  save_map(file_, grown.map);
  const StoredMap stored = read_map(file_);
  {
    MapWriter other(file_, stored.state);
    grown.step();
    other.update(grown.map);
    other.finish();
  }
  try {
    MapWriter writer(file_, stored.state);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), HasSubstr("another process has changed it"));
  }
}

TEST_F(Writing, AFileThatWasTakenAwayIsNoticed) {
  GrowingMap grown;
  for (const bool replaced : {false, true}) {
    const fs::path file = folder_ / (replaced ? "replaced.map" : "moved.map");
    MapWriter writer(file, grown.map);
    writer.update(grown.map);
    fs::rename(file, folder_ / "elsewhere");
    if (replaced) std::ofstream(file) << "another file";
    grown.grow_to(grown.steps() + 1);
    EXPECT_THROW(writer.update(grown.map), Error) << replaced;
    EXPECT_THROW(writer.finish(), Error) << replaced;
    fs::remove(folder_ / "elsewhere");
  }
}

TEST_F(Writing, ALinkIsFollowed) {
  GrowingMap grown;
  fs::create_directory(folder_ / "elsewhere");
  save_map(folder_ / "elsewhere/room.map", grown.map);
  fs::create_symlink(folder_ / "elsewhere/room.map", file_);
  {
    MapWriter writer(file_, read_map(file_).state);
    grown.step();
    writer.update(grown.map);
    writer.finish();
  }
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_EQ(difference(grown.map, read_map(file_).map), "");
}

}  // namespace
}  // namespace dkp_slam

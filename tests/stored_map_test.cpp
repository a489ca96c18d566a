#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/map_file/test_folder.h"
#include "dkp_slam/system/slam.h"
#include "tests/support/recording.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using testing::difference;
using testing::Recording;

/// A room that a camera looks around in for some seconds.
const Recording& recording() {
  static const Recording made("static_room", 24);
  return made;
}

SlamConfig options() {
  SlamConfig all;
  all.camera = recording().camera;
  all.dynamics.mode = DynamicsMode::off;
  return all;
}

/// Plays the recording; keeps the file up to date after every frame.
void play(Slam& slam, MapWriter* writer) {
  FrontEnd front_end(recording().play(), nullptr, {options().orb, false});
  while (const auto prepared = front_end.next()) {
    slam.track(*prepared);
    if (writer && writer->due()) writer->update(slam.map());
  }
  slam.finish();
  if (writer) writer->finish(slam.map());
}

class StoredMapOfARun : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    file_ = folder_ / "room.map";
  }

  fs::path file_;
};

TEST_F(StoredMapOfARun, ComesBackAsItWasAndSavingChangesNoRun) {
  Slam plain(options());
  play(plain, nullptr);
  Slam saved(options());
  MapWriter writer(file_, saved.map(), {std::chrono::milliseconds(0)});
  play(saved, &writer);
  EXPECT_EQ(difference(plain.map(), saved.map()), "");
  const Trajectory without = plain.trajectory(), with = saved.trajectory();
  ASSERT_EQ(without.size(), with.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(without[i].world_from_camera.translation, with[i].world_from_camera.translation);
  }

  const StoredMap stored = read_map(file_);
  ASSERT_GT(stored.map.live_keyframes(), 1);
  ASSERT_GT(stored.map.live_landmarks(), 100);
  EXPECT_EQ(difference(saved.map(), stored.map), "");
  EXPECT_GT(stored.state.revision, 2);
  check_fits(stored, options().camera, options().orb.scale, options().orb.levels);
}

TEST_F(StoredMapOfARun, TheNextRunAddsToIt) {
  Slam first(options());
  play(first, nullptr);
  save_map(file_, first.map());

  StoredMap stored = read_map(file_);
  MapWriter writer(file_, std::move(stored.state));
  Slam second(options(), std::move(stored.map));
  EXPECT_EQ(second.map().live_keyframes(), first.map().live_keyframes());
  EXPECT_TRUE(second.keyframe_trajectory().empty());
  play(second, &writer);
  EXPECT_GE(second.map().live_keyframes(), int(second.keyframe_trajectory().size()));
  EXPECT_EQ(difference(second.map(), read_map(file_).map), "");
}

}  // namespace
}  // namespace dkp_slam

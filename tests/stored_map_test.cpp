#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/map_file/test_folder.h"
#include "dkp_slam/system/playback.h"
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

/// Writes changes of the map to a file as they come.
struct MapFileObserver : SlamObserver {
  explicit MapFileObserver(MapWriter& w) : writer(w) {}
  void on_map(const MapChange& change) override { writer.write(change); }
  MapWriter& writer;
};

/// Plays the recording; keeps the file up to date after every frame.
void play_into(Slam& slam, MapWriter* writer) {
  if (writer) {
    slam.add_observer(std::make_shared<MapFileObserver>(*writer),
                      {.map = true, .map_interval = 0.0});
  }
  play(*recording().play(), slam);
  if (writer) writer->finish();
  EXPECT_EQ(slam.counters().observer_exceptions, 0);
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
  play_into(plain, nullptr);
  Slam saved(options());
  MapWriter writer(file_, Map(options().camera, options().orb.scale, options().orb.levels));
  play_into(saved, &writer);
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
  play_into(first, nullptr);
  save_map(file_, first.map());

  StoredMap stored = read_map(file_);
  MapWriter writer(file_, std::move(stored.state));
  Slam second(options(), nullptr, std::move(stored.map));
  play_into(second, &writer);
  EXPECT_GE(second.map().live_keyframes(), int(second.keyframe_trajectory().size()));
  EXPECT_EQ(difference(second.map(), read_map(file_).map), "");
}

}  // namespace
}  // namespace dkp_slam

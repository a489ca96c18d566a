#include "dkp_slam/map_file/map_file.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/map_file/sqlite.h"
#include "dkp_slam/map_file/test_folder.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using sqlite::Access;
using sqlite::Database;
using sqlite::Statement;
using testing::difference;
using testing::GrowingMap;
using ::testing::HasSubstr;

class MapFile : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    file_ = folder_ / "room 1 %20.map";
  }

  /// Names and contents of everything in the test's folder.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.is_directory()) continue;
      all[entry.path().filename()] = testing::content(entry.path());
    }
    return all;
  }
  void write(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
  }
  /// The file is refused in one line that names it and says `why`, and nothing changes.
  void expect_refused(const std::string& why) const {
    const auto before = contents();
    try {
      read_map(file_);
      ADD_FAILURE() << "was read; expected: " << why;
    } catch (const Error& error) {
      EXPECT_THAT(std::string(error.what()), HasSubstr(file_.string()));
      EXPECT_THAT(std::string(error.what()), HasSubstr(why));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
    EXPECT_THROW(MapWriter(file_, MapFileState{77, {}}), Error);
    EXPECT_EQ(contents(), before) << why;
  }

  fs::path file_;
};

TEST_F(MapFile, AMapComesBackAsItWas) {
  GrowingMap grown;
  grown.grow_to(75);
  const Map& map = grown.map;
  ASSERT_GT(map.live_keyframes(), 40);
  ASSERT_LT(map.live_keyframes(), map.keyframe_ids());
  ASSERT_GT(map.maps(), 2);
  save_map(file_, map);
  EXPECT_EQ(contents().size(), 1U);
  const auto before = contents();
  const StoredMap stored = read_map(file_);
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(stored.program_version, "0.1.0");
  EXPECT_EQ(stored.bytes, fs::file_size(file_));

  const Map& back = stored.map;
  EXPECT_EQ(difference(map, back), "");
  EXPECT_EQ(back.camera().depth_readout, 0.01);
  EXPECT_EQ(back.live_keyframes(), map.live_keyframes());
  EXPECT_EQ(back.live_landmarks(), map.live_landmarks());
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    ASSERT_EQ(back.keyframe(k).removed, map.keyframe(k).removed);
    if (map.keyframe(k).removed) continue;
    std::vector<int> found;
    const cv::Point2f centre = map.keyframe(k).features.pixel[5];
    back.keyframe(k).features.find(centre, 3.0F, 0, 7, found);
    EXPECT_TRUE(std::count(found.begin(), found.end(), 5));
  }
  for (int l = 0; l < map.landmark_ids(); ++l) {
    ASSERT_EQ(back.has_landmark(l), map.has_landmark(l));
    if (!map.has_landmark(l)) {
      EXPECT_EQ(back.resolve(l), -1);
      continue;
    }
    ASSERT_EQ(back.landmark(l).sightings.size(), map.landmark(l).sightings.size());
    for (std::size_t s = 0; s < map.landmark(l).sightings.size(); ++s) {
      EXPECT_EQ(back.landmark(l).sightings[s].keyframe, map.landmark(l).sightings[s].keyframe);
      EXPECT_EQ(back.landmark(l).sightings[s].feature, map.landmark(l).sightings[s].feature);
    }
  }
}

TEST_F(MapFile, WhatFollowsFromTheRestIsComputedAnew) {
  GrowingMap grown;
  grown.grow_to(30);
  save_map(file_, grown.map);
  StoredMap stored = read_map(file_);
  for (int l = 0; l < grown.map.landmark_ids(); ++l) {
    if (!grown.map.has_landmark(l)) continue;
    grown.map.refresh(l);
    const Landmark &a = grown.map.landmark(l), &b = stored.map.landmark(l);
    EXPECT_EQ(a.descriptor, b.descriptor);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.min_distance, b.min_distance);
    EXPECT_EQ(a.max_distance, b.max_distance);
  }
  const int newest = grown.map.keyframe_ids() - 1;
  grown.map.update_covisibility(newest);
  EXPECT_FALSE(grown.map.keyframe(newest).covisible.empty());
  for (const auto& [other, shared] : grown.map.keyframe(newest).covisible) {
    EXPECT_EQ(stored.map.keyframe(newest).covisible.at(other), shared);
    EXPECT_EQ(stored.map.keyframe(other).covisible.at(newest), shared);
  }
}

TEST_F(MapFile, ALoadedMapCanGrowOnAndBeSavedAgain) {
  GrowingMap grown;
  grown.grow_to(10);
  save_map(file_, grown.map);
  StoredMap stored = read_map(file_);
  grown.map = stored.map;
  grown.grow_to(40);
  for (int k = 30; k < grown.map.keyframe_ids(); ++k) {
    EXPECT_TRUE(grown.map.keyframe_pose(k).translation.allFinite()) << k;
  }
  save_map(folder_ / "again.map", grown.map);
  EXPECT_EQ(difference(grown.map, read_map(folder_ / "again.map").map), "");
}

TEST_F(MapFile, NothingIsWrittenOver) {
  write("mine");
  const auto before = contents();
  EXPECT_THROW(save_map(file_, GrowingMap().map), Error);
  EXPECT_THROW(MapWriter(file_, GrowingMap().map), Error);
  EXPECT_EQ(contents(), before);
}

TEST_F(MapFile, PlacesWhereNoFileCanBe) {
  const auto refusal = [](const fs::path& file) -> std::string {
    try {
      create_map_file(file, GrowingMap().map);
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_THAT(refusal(folder_ / "no/folder.map"), HasSubstr("no does not exist"));
  EXPECT_THAT(refusal("/proc/room.map"), HasSubstr("/proc/room.map: cannot be opened"));
  EXPECT_THAT(refusal(folder_), HasSubstr("is there already"));
  EXPECT_TRUE(contents().empty());
}

TEST_F(MapFile, FilesThatAreNoMaps) {
  expect_refused("no such map file");
  write("");
  expect_refused("is empty, no map");
  write("SQLi");
  expect_refused("is cut off after 4 bytes");
  write("# timestamp tx ty tz qx qy qz qw\n" + std::string(5000, '1'));
  expect_refused("is no map file of dkp-slam");
  fs::remove(file_);
  fs::create_directory(file_);
  expect_refused("is a folder");
  fs::remove(file_);
  {
    Database database(file_, Access::create);
    database.run("CREATE TABLE songs (id INTEGER PRIMARY KEY)");
  }
  expect_refused("is another program's database");
}

TEST_F(MapFile, OtherVersions) {
  save_map(file_, GrowingMap().map);
  const auto set_version = [&](int version) {
    Database database(file_, Access::exclusive);
    database.run(("PRAGMA user_version = " + std::to_string(version)).c_str());
  };
  set_version(2);
  expect_refused("is a map of format 2, this program reads format 1 only; use the newer");
  set_version(0);
  expect_refused("is a map of format 0, this program reads format 1 only; use the older");
}

TEST_F(MapFile, FilesThatAreCutOff) {
  GrowingMap grown;
  grown.grow_to(20);
  save_map(file_, grown.map);
  const std::string whole = contents().begin()->second;
  for (const std::size_t size : {std::size_t{50}, std::size_t{99}, std::size_t{100},
                                 std::size_t{4096}, whole.size() / 2, whole.size() - 1}) {
    write(whole.substr(0, size));
    expect_refused("is cut off");
  }
}

TEST_F(MapFile, PagesOfRubbish) {
  GrowingMap grown;
  grown.grow_to(20);
  save_map(file_, grown.map);
  const std::string whole = contents().begin()->second;
  std::mt19937_64 random(3);
  for (int i = 0; i < 40; ++i) {
    // Each page is of use: where SQLite itself finds nothing wrong with one, it holds a BLOB's
    // bytes, and then either these make no map or they make one.
    std::string broken = whole;
    const std::size_t page = 4096 * (1 + random() % (whole.size() / 4096 - 1));
    for (std::size_t k = 0; k < 4096; ++k) broken[page + k] = static_cast<char>(random());
    write(broken);
    const auto before = contents();
    try {
      EXPECT_EQ(parts_of(read_map(file_).map).check(), std::nullopt);
    } catch (const Error& error) {
      EXPECT_THAT(std::string(error.what()), HasSubstr("damaged"));
    }
    EXPECT_EQ(contents(), before);
  }
}

/// A way to spoil a file, and what is to be said about it.
struct Damage {
  std::string sql, why;
};

TEST_F(MapFile, ValuesThatMakeNoMap) {
  GrowingMap grown;
  grown.grow_to(20);
  save_map(file_, grown.map);
  const std::string whole = contents().begin()->second;
  const Damage damages[] = {
      {"UPDATE keyframes SET landmarks = x'0000' WHERE id = 7", "keyframe 7: 2 bytes where 400"},
      {"UPDATE features SET pixel = x'' WHERE keyframe = 7", "keyframe 7: 0 bytes where 800"},
      {"UPDATE features SET level = x'00' WHERE keyframe = 7", "keyframe 7: 800 bytes where 8"},
      {"UPDATE features SET descriptor = 3", "descriptor holds a value of the wrong type"},
      {"UPDATE features SET level = zeroblob(99) || x'08' WHERE keyframe = 7", "wrong type"},
      {"DELETE FROM features WHERE keyframe = 7", "keyframe 7 and its features do not pair"},
      {"DELETE FROM keyframes WHERE id = 19", "features without a keyframe"},
      {"UPDATE keyframes SET tx = NULL WHERE id = 7", "tx holds a value of the wrong type"},
      {"UPDATE keyframes SET tx = 9e999 WHERE id = 7", "keyframe 7: its pose is none"},
      {"UPDATE keyframes SET qw = 3 WHERE id = 7", "keyframe 7: its pose is none"},
      {"UPDATE keyframes SET timestamp = 9e999 WHERE id = 7", "its time stamp is no number"},
      {"UPDATE keyframes SET parent = 9999 WHERE id = 7", "its parent 9999 is not there"},
      {"UPDATE keyframes SET parent = 7 WHERE id = 7", "its own ancestor"},
      {"UPDATE keyframes SET parent = 13 - id WHERE id IN (6, 7)", "its own ancestor"},
      {"UPDATE keyframes SET map = 5 WHERE id = 7; INSERT INTO maps VALUES (5)", "to no map (5)"},
      {"DELETE FROM maps", "maps and keyframes do not match"},
      {"DELETE FROM landmarks WHERE id = 0", "sees landmark 0, which is not there"},
      {"INSERT INTO landmarks SELECT 5000000000, x, y, z, 0, 1, 1, 0.0 FROM landmarks LIMIT 1",
       "id holds 5000000000"},
      {"UPDATE landmarks SET x = NULL WHERE id = 0", "x holds a value of the wrong type"},
      {"UPDATE landmarks SET z = -9e999 WHERE id = 0", "landmark 0: its position is none"},
      {"UPDATE landmarks SET first_keyframe = 999 WHERE id = 0", "landmark 0: no keyframe made it"},
      {"UPDATE landmarks SET found = 0 WHERE id = 0", "landmark 0: its counts are impossible"},
      {"UPDATE meta SET value = 3 WHERE key = 'keyframe_ids'", "keyframes' ids are out of range"},
      {"UPDATE meta SET value = 3 WHERE key = 'landmark_ids'", "landmarks' ids are out of range"},
      {"UPDATE meta SET value = 2000000000 WHERE key = 'landmark_ids'", "no sensible number"},
      {"UPDATE meta SET value = 7 WHERE key = 'current_map'", "no sensible number of maps"},
      {"UPDATE meta SET value = '{}' WHERE key = 'camera'", "camera: "},
      {"UPDATE meta SET value = replace(value, '\"fx\":500', '\"fx\":-1')", "camera: fx must be"},
      {"UPDATE meta SET value = replace(value, '\"width\":640', '\"width\":640000000')",
       "camera: no camera has so many pixels"},
      {"UPDATE meta SET value = replace(value, '\"width\":640', '\"width\":1e300')",
       "camera: 'width' is no whole number in its range"},
      {"DELETE FROM meta WHERE key = 'camera'", "meta has no camera"},
      {"DELETE FROM meta WHERE key = 'revision'", "meta has no revision"},
      {"DROP TABLE landmarks", "no such table: landmarks"},
      {"ALTER TABLE landmarks DROP COLUMN found", "wrong type"},
  };
  for (const Damage& damage : damages) {
    write(whole);
    {
      Database database(file_, Access::exclusive);
      database.run(damage.sql.c_str());
    }
    SCOPED_TRACE(damage.sql);
    expect_refused("damaged map file: ");
    expect_refused(damage.why);
  }
}

TEST_F(MapFile, SightingsThatMakeNoMap) {
  GrowingMap grown;
  grown.grow_to(3);
  const MapParts good = parts_of(grown.map);
  const auto expect_damaged = [&](const std::function<void(MapParts&)>& spoil,
                                  const std::string& why) {
    MapParts parts = good;
    spoil(parts);
    EXPECT_THAT(parts.check().value_or(""), HasSubstr(why));
  };
  EXPECT_EQ(good.check(), std::nullopt);
  const auto seen = static_cast<std::size_t>(std::find_if(good.keyframes[2].landmarks.begin(),
                                                          good.keyframes[2].landmarks.end(),
                                                          [](int l) { return l >= 0; }) -
                                             good.keyframes[2].landmarks.begin());
  expect_damaged(
      [&](MapParts& p) { p.keyframes[2].landmarks[99] = p.keyframes[2].landmarks[seen]; },
      "keyframe 2: it sees landmark");
  expect_damaged([&](MapParts& p) { p.keyframes[1].landmarks[3] = -7; },
                 "it sees landmark -7, which is not there");
  expect_damaged(
      [&](MapParts& p) {
        p.landmarks.push_back(p.landmarks.back());
        p.landmarks.back().id = p.landmark_ids++;
      },
      "no keyframe sees it");
  expect_damaged([&](MapParts& p) { p.keyframes[1].features.level[3] = 8; }, "on no level");
  expect_damaged([&](MapParts& p) { p.keyframes[1].features.depth[3] = -1.0F; }, "depth");
  expect_damaged(
      [&](MapParts& p) {
        p.keyframes[1].features.pixel[3].x = std::numeric_limits<float>::quiet_NaN();
      },
      "lies nowhere");
}

TEST_F(MapFile, AnotherCamera) {
  save_map(file_, GrowingMap().map);
  const StoredMap stored = read_map(file_);
  Camera camera = testing::test_camera();
  camera.name = "the same by another name";
  camera.depth_scale = 1000.0;
  check_fits(stored, camera, 1.2F, 8);
  const auto refusal = [&](const Camera& other, float scale, int levels) -> std::string {
    try {
      check_fits(stored, other, scale, levels);
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_THAT(refusal(camera, 1.3F, 8), HasSubstr("8 pyramid levels 1.200 apart there"));
  EXPECT_THAT(refusal(camera, 1.2F, 7), HasSubstr("7 levels 1.200 apart here"));
  camera.fy = 501.5;
  EXPECT_THAT(refusal(camera, 1.2F, 8), HasSubstr("fy is 500 there and 501.5 here"));
  EXPECT_THAT(refusal(camera, 1.2F, 8), HasSubstr(file_.string()));
}

TEST_F(MapFile, MergedMapsLieSideBySide) {
  GrowingMap a, b(60);
  a.grow_to(25);
  b.grow_to(8);
  const MapParts both = merged(parts_of(a.map), parts_of(b.map));
  EXPECT_EQ(both.check(), std::nullopt);
  const Map map(both);
  EXPECT_EQ(map.maps(), a.map.maps() + b.map.maps());
  EXPECT_EQ(map.live_keyframes(), a.map.live_keyframes() + b.map.live_keyframes());
  EXPECT_EQ(map.live_landmarks(), a.map.live_landmarks() + b.map.live_landmarks());
  EXPECT_EQ(map.keyframes_in(0), a.map.keyframes_in(0));
  const int shift = a.map.keyframe_ids();
  EXPECT_EQ(map.keyframe(shift + 3).map, a.map.maps());
  EXPECT_EQ(map.keyframe_pose(shift + 3).translation, b.map.keyframe_pose(3).translation);
  EXPECT_EQ(map.keyframe(shift + 3).landmarks.size(), 60U);
  // Landmarks are counted anew, those of the second after those of the first.
  EXPECT_EQ(map.landmark_ids(), map.live_landmarks());
  EXPECT_EQ(map.landmarks_of(map.keyframes_in(a.map.maps())).front(), a.map.live_landmarks());
}

TEST_F(MapFile, NumbersOfIdsCostLittle) {
  GrowingMap grown;
  grown.grow_to(10);
  save_map(file_, grown.map);
  {
    Database database(file_, Access::exclusive);
    database.run("UPDATE meta SET value = 10000000 WHERE key = 'keyframe_ids'");
    database.run("UPDATE meta SET value = 1900000000 WHERE key = 'landmark_ids'");
  }
  StoredMap stored = read_map(file_);
  EXPECT_EQ(stored.map.keyframe_ids(), 10'000'000);
  EXPECT_EQ(stored.map.live_keyframes(), grown.map.live_keyframes());
  EXPECT_TRUE(stored.map.keyframe(9'999'999).removed);
  EXPECT_LT(stored.map.memory(), grown.map.memory() + 10'000'000 * 2 * sizeof(int));
  const int keyframe = stored.map.keyframes_in(0).front();
  EXPECT_THROW(stored.map.add_landmark({0.0, 0.0, 1.0}, keyframe, 0), Error) << "the last is given";
}

TEST_F(MapFile, WhatTheReaderRefusesIsNotWritten) {
  GrowingMap grown;
  grown.grow_to(5);
  save_map(file_, grown.map);
  MapParts parts = parts_of(grown.map);
  parts.keyframe_ids = most_keyframe_ids + 1;
  const fs::path other = folder_ / "other.map";
  EXPECT_THROW(save_map(other, Map(parts)), Error);
  EXPECT_FALSE(fs::exists(other));
  StoredMap stored = read_map(file_);
  MapWriter writer(file_, std::move(stored.state));
  EXPECT_THROW(writer.update(Map(parts)), Error);
  writer.finish();
  EXPECT_EQ(read_map(file_).map.keyframe_ids(), grown.map.keyframe_ids());
}

TEST_F(MapFile, LandmarksAreNumberedAnewInTheFile) {
  GrowingMap grown;
  grown.grow_to(20);
  save_map(file_, grown.map);
  StoredMap stored = read_map(file_);
  const Map renumbered(with_new_landmark_ids(parts_of(stored.map)));
  EXPECT_LT(renumbered.landmark_ids(), stored.map.landmark_ids()) << "else this shows nothing";
  MapWriter writer(file_, std::move(stored.state));
  writer.update(renumbered);
  writer.finish();
  const Map read = read_map(file_).map;
  EXPECT_EQ(read.landmark_ids(), grown.map.live_landmarks());
  const std::vector<int> before = grown.map.landmarks(), after = read.landmarks();
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i], static_cast<int>(i));
    EXPECT_EQ(read.landmark(after[i]).position, grown.map.landmark(before[i]).position);
    EXPECT_EQ(read.landmark(after[i]).sightings.size(),
              grown.map.landmark(before[i]).sightings.size());
  }
}

}  // namespace
}  // namespace dkp_slam

#include "dkp_slam/map_file/map_rows.h"

#include <array>
#include <bit>
#include <cstring>
#include <exception>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/json_integer.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/version.h"

namespace dkp_slam {
namespace {

using sqlite::Database;
using sqlite::Statement;

static_assert(std::endian::native == std::endian::little,
              "values are stored little-endian as they lie in memory");
static_assert(sizeof(cv::Point2f) == 8 && sizeof(Descriptor) == 32 && sizeof(int) == 4);

constexpr int most_image_side = 100'000;

constexpr const char* schema = R"(
CREATE TABLE meta (key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE maps (id INTEGER PRIMARY KEY);
CREATE TABLE keyframes (
  id INTEGER PRIMARY KEY, map INTEGER NOT NULL, frame_index INTEGER NOT NULL, timestamp REAL,
  qx REAL, qy REAL, qz REAL, qw REAL, tx REAL, ty REAL, tz REAL,
  parent INTEGER, landmarks BLOB NOT NULL);
CREATE TABLE features (
  keyframe INTEGER PRIMARY KEY, pixel BLOB NOT NULL, depth BLOB NOT NULL, level BLOB NOT NULL,
  angle BLOB NOT NULL, descriptor BLOB NOT NULL);
CREATE TABLE landmarks (
  id INTEGER PRIMARY KEY, x REAL, y REAL, z REAL, first_keyframe INTEGER NOT NULL,
  visible INTEGER NOT NULL, found INTEGER NOT NULL, dynamic_log_odds REAL);
)";

nlohmann::ordered_json to_json(const Camera& c, float level_scale, int levels) {
  const Distortion& d = c.distortion;
  nlohmann::ordered_json json = {{"name", c.name},
                                 {"width", c.width},
                                 {"height", c.height},
                                 {"fx", c.fx},
                                 {"fy", c.fy},
                                 {"cx", c.cx},
                                 {"cy", c.cy},
                                 {"distortion", {d.k1, d.k2, d.p1, d.p2, d.k3}},
                                 {"depth_scale", c.depth_scale},
                                 {"min_depth", c.min_depth},
                                 {"max_depth", c.max_depth},
                                 {"baseline", c.baseline},
                                 {"frame_rate", c.frame_rate},
                                 {"readout", c.readout},
                                 {"depth_noise", {c.depth_noise.constant, c.depth_noise.quadratic}},
                                 {"level_scale", level_scale},
                                 {"levels", levels}};
  if (c.depth_readout) json["depth_readout"] = *c.depth_readout;
  return json;
}

void from_json(const nlohmann::json& json, MapParts& parts) {
  Camera& c = parts.camera;
  json.at("name").get_to(c.name);
  c.width = integer_at<int>(json, "width");
  c.height = integer_at<int>(json, "height");
  json.at("fx").get_to(c.fx);
  json.at("fy").get_to(c.fy);
  json.at("cx").get_to(c.cx);
  json.at("cy").get_to(c.cy);
  const auto d = json.at("distortion").get<std::array<double, 5>>();
  c.distortion = {d[0], d[1], d[2], d[3], d[4]};
  json.at("depth_scale").get_to(c.depth_scale);
  json.at("min_depth").get_to(c.min_depth);
  json.at("max_depth").get_to(c.max_depth);
  json.at("baseline").get_to(c.baseline);
  json.at("frame_rate").get_to(c.frame_rate);
  json.at("readout").get_to(c.readout);
  if (json.contains("depth_readout")) json.at("depth_readout").get_to(c.depth_readout.emplace());
  const auto noise = json.at("depth_noise").get<std::array<double, 2>>();
  c.depth_noise = {noise[0], noise[1]};
  json.at("level_scale").get_to(parts.level_scale);
  parts.levels = integer_at<int>(json, "levels");
}

template <class Value>
void set_meta(Database& database, const char* key, const Value& value) {
  Statement(database, "INSERT OR REPLACE INTO meta VALUES (?, ?)")
      .bind(1, std::string_view(key))
      .bind(2, value)
      .execute();
}

Statement meta(Database& database, const char* key) {
  Statement row(database, "SELECT value FROM meta WHERE key = ?");
  row.bind(1, std::string_view(key));
  if (!row.step()) sqlite::throw_damaged(database.file(), fmt::format("meta has no {}", key));
  return row;
}

void remove_rows(Database& database, const char* sql, const std::vector<int>& ids) {
  if (ids.empty()) return;
  Statement row(database, sql);
  for (const int id : ids) row.bind(1, id).execute();
}

void write_keyframes(Database& database, const MapChange& change) {
  Statement row(database,
                "INSERT OR REPLACE INTO keyframes VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const KeyframeState& k : change.keyframes) {
    const Eigen::Quaterniond& q = k.camera_from_world.rotation;
    const Eigen::Vector3d& t = k.camera_from_world.translation;
    row.bind(1, k.id).bind(2, k.map).bind(3, k.frame_index).bind(4, k.timestamp);
    row.bind(5, q.x()).bind(6, q.y()).bind(7, q.z()).bind(8, q.w());
    row.bind(9, t.x()).bind(10, t.y()).bind(11, t.z());
    if (k.parent < 0) {
      row.bind_null(12);
    } else {
      row.bind(12, k.parent);
    }
    row.bind_blob(13, std::span(k.landmarks)).execute();
  }
  Statement looks(database, "INSERT OR REPLACE INTO features VALUES (?, ?, ?, ?, ?, ?)");
  for (const KeyframeLooks& k : change.looks) {
    looks.bind(1, k.id)
        .bind_blob(2, std::span(k.features.pixel))
        .bind_blob(3, std::span(k.features.depth))
        .bind_blob(4, std::span(k.features.level))
        .bind_blob(5, std::span(k.features.angle))
        .bind_blob(6, std::span(k.features.descriptor))
        .execute();
  }
}

void write_landmarks(Database& database, const MapChange& change) {
  Statement row(database, "INSERT OR REPLACE INTO landmarks VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const LandmarkState& l : change.landmarks) {
    row.bind(1, l.id).bind(2, l.position.x()).bind(3, l.position.y()).bind(4, l.position.z());
    row.bind(5, l.first_keyframe).bind(6, l.visible).bind(7, l.found);
    row.bind(8, double{l.dynamic_log_odds}).execute();
  }
}

void write_counts(Database& database, const MapChange& change) {
  set_meta(database, "keyframe_ids", change.keyframe_ids);
  set_meta(database, "landmark_ids", change.landmark_ids);
  set_meta(database, "maps", change.maps);
  set_meta(database, "current_map", change.current_map);
  database.run("DELETE FROM maps");
  Statement row(database, "INSERT INTO maps VALUES (?)");
  for (const int id : change.live_maps) row.bind(1, id).execute();
}

/// The column's BLOB as values; `count`: how many they must be.
template <class T>
std::vector<T> values(const Database& database, const Statement& row, int column, int keyframe,
                      std::size_t count) {
  const std::span<const std::byte> bytes = row.blob(column);
  if (bytes.size() != count * sizeof(T)) {
    sqlite::throw_damaged(database.file(), fmt::format("keyframe {}: {} bytes where {} belong",
                                                       keyframe, bytes.size(), count * sizeof(T)));
  }
  std::vector<T> out(count);
  if (count > 0) std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

FrameFeatures read_features(const Database& database, const Statement& row, int id,
                            const Camera& camera) {
  const std::size_t count = row.blob(3).size();  // of the levels, a byte each
  auto pixels = values<cv::Point2f>(database, row, 1, id, count);
  for (const cv::Point2f& p : pixels) {
    if (!is_pixel(p))
      sqlite::throw_damaged(database.file(), fmt::format("keyframe {}: a pixel is none", id));
  }
  return {camera,
          std::move(pixels),
          values<float>(database, row, 2, id, count),
          values<std::uint8_t>(database, row, 3, id, count),
          values<float>(database, row, 4, id, count),
          values<Descriptor>(database, row, 5, id, count)};
}

void read_keyframes(Database& database, MapParts& parts) {
  // Both tables side by side in the order of the ids, each read from front to back.
  Statement row(database, "SELECT * FROM keyframes ORDER BY id");
  Statement looks(database, "SELECT * FROM features ORDER BY keyframe");
  while (row.step()) {
    Keyframe k;
    k.id = row.small_integer(0);
    k.map = row.small_integer(1);
    k.frame_index = row.small_integer(2);
    k.timestamp = row.real(3);
    // Not by Eigen's <<, which asserts that it came to its end, also where a value throws.
    k.camera_from_world.rotation =
        Eigen::Quaterniond(row.real(7), row.real(4), row.real(5), row.real(6));
    k.camera_from_world.translation = Eigen::Vector3d(row.real(8), row.real(9), row.real(10));
    k.parent = row.null(11) ? -1 : row.small_integer(11);
    if (!looks.step() || looks.small_integer(0) != k.id) {
      sqlite::throw_damaged(database.file(),
                            fmt::format("keyframe {} and its features do not pair", k.id));
    }
    k.features = read_features(database, looks, k.id, parts.camera);
    k.landmarks = values<int>(database, row, 12, k.id, static_cast<std::size_t>(k.features.size()));
    parts.keyframes.push_back(std::move(k));
  }
  if (looks.step()) sqlite::throw_damaged(database.file(), "features without a keyframe");
}

void read_landmarks(Database& database, MapParts& parts) {
  Statement row(database, "SELECT * FROM landmarks ORDER BY id");
  while (row.step()) {
    Landmark l;
    l.id = row.small_integer(0);
    l.position = Eigen::Vector3d(row.real(1), row.real(2), row.real(3));
    l.first_keyframe = row.small_integer(4);
    l.visible = row.small_integer(5);
    l.found = row.small_integer(6);
    l.dynamic_log_odds = static_cast<float>(row.real(7));
    parts.landmarks.push_back(std::move(l));
  }
}

/// The table of maps must name those that the keyframes name.
void check_maps(Database& database, const MapParts& parts) {
  std::set<int> named, used;
  Statement row(database, "SELECT id FROM maps");
  while (row.step()) named.insert(row.small_integer(0));
  for (const Keyframe& k : parts.keyframes) used.insert(k.map);
  if (named != used) sqlite::throw_damaged(database.file(), "maps and keyframes do not match");
}

}  // namespace

void create_map_tables(Database& database, const Camera& camera, float level_scale, int levels) {
  database.run(fmt::format("PRAGMA application_id = {}", map_application_id).c_str());
  sqlite::Transaction transaction(database);
  database.run(schema);
  set_meta(database, "program_version", std::string_view(DKP_SLAM_VERSION));
  set_meta(database, "camera",
           std::string_view(json_text(to_json(camera, level_scale, levels), -1)));
  set_meta(database, "revision", 0);
  MapChange nothing;
  write_counts(database, nothing);
  database.run(fmt::format("PRAGMA user_version = {}", map_format_version).c_str());
  transaction.commit();
}

void write_change(Database& database, const MapChange& change) {
  // What the reader refuses is not written.
  if (const auto problem = problem_of_counts(change.keyframe_ids, change.landmark_ids, change.maps,
                                             change.current_map)) {
    throw Error(fmt::format(
        "{}: the map has given more numbers than can be read again ({}); the file holds what came "
        "before, go on with it in a new run",
        database.file().string(), *problem));
  }
  sqlite::Transaction transaction(database);
  remove_rows(database, "DELETE FROM keyframes WHERE id = ?", change.removed_keyframes);
  remove_rows(database, "DELETE FROM features WHERE keyframe = ?", change.removed_keyframes);
  remove_rows(database, "DELETE FROM landmarks WHERE id = ?", change.removed_landmarks);
  write_keyframes(database, change);
  write_landmarks(database, change);
  if (change.counts_changed) write_counts(database, change);
  set_meta(database, "program_version", std::string_view(DKP_SLAM_VERSION));
  database.run("UPDATE meta SET value = value + 1 WHERE key = 'revision'");
  transaction.commit();
}

std::int64_t map_revision(Database& database) { return meta(database, "revision").integer(0); }

std::string map_program_version(Database& database) {
  return meta(database, "program_version").text(0);
}

MapParts read_parts(Database& database) {
  MapParts parts;
  const std::string camera = meta(database, "camera").text(0);
  try {
    from_json(nlohmann::json::parse(camera), parts);
  } catch (const std::exception& error) {
    sqlite::throw_damaged(database.file(), fmt::format("camera: {}", error.what()));
  }
  // It is computed with before the rest can be checked.
  if (const auto reason = parts.camera.check())
    sqlite::throw_damaged(database.file(), fmt::format("camera: {}", *reason));
  if (parts.camera.width > most_image_side || parts.camera.height > most_image_side)
    sqlite::throw_damaged(database.file(), "camera: no camera has so many pixels");
  parts.keyframe_ids = meta(database, "keyframe_ids").small_integer(0);
  parts.landmark_ids = meta(database, "landmark_ids").small_integer(0);
  parts.maps = meta(database, "maps").small_integer(0);
  parts.current_map = meta(database, "current_map").small_integer(0);
  read_keyframes(database, parts);
  read_landmarks(database, parts);
  check_maps(database, parts);
  return parts;
}

}  // namespace dkp_slam

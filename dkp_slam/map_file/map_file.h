#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dkp_slam/map/map.h"
#include "dkp_slam/map/map_changes.h"

namespace dkp_slam {

/// Knows what a map file holds, so that a MapWriter can go on from there.
struct MapFileState {
  std::int64_t revision = 0;  ///< transactions so far
  ChangeFinder finder;
};

/// A map that was read from a file (docs/map-format.md).
struct StoredMap {
  std::filesystem::path file;
  Map map;
  MapFileState state;
  std::string program_version;  ///< that wrote it last
  std::uintmax_t bytes = 0;     ///< of the file and the log beside it
};

/// Reads a map file, whole. Its writer may have been killed: the map is then as it was at the last
/// commit. Changes nothing, neither in the file nor beside it. Throws `Error` for a file that is
/// missing, empty, of another program or another format version, cut off or damaged, or in use by
/// another process.
StoredMap read_map(const std::filesystem::path& file);

/// Throws `Error` unless a map made with that file's camera and pyramid can be gone on with.
void check_fits(const StoredMap& stored, const Camera& camera, float level_scale, int levels);

/// Makes a new map file of the whole map, complete or not at all. Throws `Error` where a file of
/// that name is there already or cannot be made.
void save_map(const std::filesystem::path& file, const Map& map);

/// Makes a file that holds no keyframes yet. Throws as `save_map` does.
void create_map_file(const std::filesystem::path& file, const Map& map);

/// Throws `Error` unless the first bytes are those of a map file of our version, found out by plain
/// reading: a file of others is never handed to SQLite, which might write to it.
void check_map_header(const std::filesystem::path& file);

}  // namespace dkp_slam

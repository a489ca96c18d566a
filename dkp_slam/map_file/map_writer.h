#pragma once

#include <filesystem>
#include <memory>

#include "dkp_slam/map/map_changes.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/sqlite.h"

namespace dkp_slam {

/// Keeps a map file up to date while the map grows: each change is one transaction, so that a
/// process that is killed leaves the map as it was after one of them. Belongs to one thread at a
/// time; an observer of the system has one of its own.
class MapWriter {
 public:
  /// Makes a new file, for a map with this one's camera. Throws `Error`, see create_map_file.
  MapWriter(const std::filesystem::path& file, const Map& map);
  /// Goes on with the file that was read. Throws `Error` where it is in use, cannot be written, or
  /// has changed since.
  MapWriter(const std::filesystem::path& file, MapFileState state);
  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;

  /// Commits a change to what the file holds. Throws `Error` where that fails; the file then holds
  /// what was committed before.
  void write(const MapChange& change);
  /// Finds what in the map differs from what the file holds, and commits that. Not together with
  /// changes from elsewhere.
  void update(const Map& map) { write(state_.finder.find(map)); }
  /// Waits until everything is in the file itself, and lets go of it.
  void finish();

 private:
  MapFileState state_;
  std::unique_ptr<sqlite::Database> database_;
};

}  // namespace dkp_slam

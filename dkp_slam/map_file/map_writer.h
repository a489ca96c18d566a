#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "dkp_slam/map_file/map_changes.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/sqlite.h"

namespace dkp_slam {

struct MapWriterOptions {
  /// Time from one update to the next. A process that is killed loses what is younger than this and
  /// the time of a commit; half a second leaves room to keep that under one second.
  std::chrono::milliseconds interval{500};
};

/// Keeps a map file up to date while the map grows. The tracking thread says when, and finds what
/// changed; a thread of the writer's own commits that, as values, in one transaction.
///
/// At most one change waits: while the thread is behind, `due` is false and the next update covers
/// more. Locking rule: the values handed over, `busy_` and `failure_` are guarded by one mutex; the
/// database belongs to the thread from its start to its end; everything else to the caller.
class MapWriter {
 public:
  /// Makes a new file, for a map with this one's camera. Throws `Error`, see create_map_file.
  MapWriter(const std::filesystem::path& file, const Map& map,
            const MapWriterOptions& options = {});
  /// Goes on with the file that was read. Throws `Error` where it is in use, cannot be written, or
  /// has changed since.
  MapWriter(const std::filesystem::path& file, MapFileState state,
            const MapWriterOptions& options = {});
  /// Without `finish`: keeps what was handed over.
  ~MapWriter();
  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;

  /// True when an update is worth its time now.
  bool due() const;
  /// Hands over what changed in the map, unless the thread is still busy. Throws `Error` when a
  /// commit has failed; the file then holds what was committed before, and nothing more will come.
  void update(const Map& map);
  /// The last update: waits for it and for everything to be in the file itself, and lets go of it.
  /// Throws as `update`.
  void finish(const Map& map);

 private:
  using Clock = std::chrono::steady_clock;

  void work();
  void hand_over(const Map& map);
  void stop();
  void throw_failure() const;

  const MapWriterOptions options_;
  MapFileState state_;
  std::unique_ptr<sqlite::Database> database_;
  std::optional<Clock::time_point> updated_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  MapChange change_;
  bool busy_ = false;  // there is a change that is not committed yet
  bool closing_ = false;
  std::string failure_;
  std::thread thread_;
};

}  // namespace dkp_slam

#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/system/config.h"
#include "dkp_slam/system/file_observer.h"

namespace dkp_slam {

/// The map file of a run, if there is one.
class RunMap : public FileObserver {
 public:
  /// Reads what there is to start from; leaves everything as it is. At most one of the two names.
  /// Throws `Error` where the file cannot be used.
  RunMap(const std::filesystem::path& map, const std::filesystem::path& localize,
         const SlamConfig& config);

  /// The map that was read; once. Takes hold of the file that the run goes on with; where its
  /// landmarks' ids are many they are counted anew, there as well. Throws `Error` when it cannot be
  /// written.
  std::optional<Map> take_stored();
  /// After `take_stored`: makes the file where there was none; false where the run keeps none. From
  /// here on the file follows the map as this observer is told. Throws `Error` when it cannot be
  /// written.
  bool begin(const SlamConfig& config);
  void on_map(const MapChange& change) override;
  /// After the run: everything is in the file itself. Throws `Error` when something could not be
  /// written, now or before; the file then holds what was committed before.
  void finish();

 private:
  const std::filesystem::path file_;  // to keep up to date; empty for none
  std::optional<StoredMap> stored_;
  std::unique_ptr<MapWriter> writer_;  // the observer's thread's, between `begin` and `finish`
  bool warned_ = false;                // that ids get few
};

}  // namespace dkp_slam

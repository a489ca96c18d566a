#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_writer.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam::apps {

/// The map file of a run, if there is one.
class RunMap {
 public:
  /// Reads what there is to start from; leaves everything as it is. At most one of the two names.
  /// Throws `Error` where the file cannot be used.
  RunMap(const std::filesystem::path& map, const std::filesystem::path& localize,
         const SlamConfig& options);

  /// The map that was read; once.
  std::optional<Map> take_stored();
  /// Makes or takes hold of the file. From here on all throw `Error` when it cannot be written.
  void begin(const Map& map);
  /// After every frame.
  void update(const Map& map);
  void finish(const Map& map);

 private:
  const std::filesystem::path file_;  // to keep up to date; empty for none
  std::optional<StoredMap> stored_;
  std::unique_ptr<MapWriter> writer_;
};

}  // namespace dkp_slam::apps

#include "dkp_slam/map_file/map_writer.h"

#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/map_rows.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

MapFileState state_of_new(const fs::path& file, const Map& map) {
  create_map_file(file, map);
  return {};
}

}  // namespace

MapWriter::MapWriter(const fs::path& file, const Map& map)
    : MapWriter(file, state_of_new(file, map)) {}

MapWriter::MapWriter(const fs::path& file, MapFileState state) : state_(std::move(state)) {
  check_map_header(file);
  database_ = std::make_unique<sqlite::Database>(file, sqlite::Access::exclusive);
  if (map_revision(*database_) != state_.revision) {
    throw Error(
        fmt::format("{}: another process has changed it meanwhile; start again", file.string()));
  }
}

void MapWriter::write(const MapChange& change) {
  if (change.empty()) return;
  database_->check_in_place();
  write_change(*database_, change);
}

void MapWriter::finish() {
  if (!database_) return;
  database_->check_in_place();
  database_->checkpoint();
  database_.reset();
}

}  // namespace dkp_slam

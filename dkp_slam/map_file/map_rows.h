#pragma once

#include <cstdint>
#include <string>

#include "dkp_slam/map/map_changes.h"
#include "dkp_slam/map/map_parts.h"
#include "dkp_slam/map_file/sqlite.h"

namespace dkp_slam {

/// "DKPS", in the header of every map file (PRAGMA application_id).
constexpr std::uint32_t map_application_id = 0x444B5053;
/// Of the tables, see docs/map-format.md (PRAGMA user_version).
constexpr std::uint32_t map_format_version = 1;

/// Makes the tables in an empty database, in one transaction: a map of nothing.
void create_map_tables(sqlite::Database& database, const Camera& camera, float level_scale,
                       int levels);

/// Writes what changed, in one transaction, and counts `revision` in the file up by one.
void write_change(sqlite::Database& database, const MapChange& change);

/// How often the file was written to.
std::int64_t map_revision(sqlite::Database& database);
/// Version of the program that wrote last.
std::string map_program_version(sqlite::Database& database);

/// Everything in the file. Throws `Error` where a value is of the wrong type or length; whether the
/// values make a map is for MapParts::check to say.
MapParts read_parts(sqlite::Database& database);

}  // namespace dkp_slam

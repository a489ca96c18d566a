#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/map_file/map_file.h"

namespace dkp_slam::apps {

/// One of a file's maps in figures.
struct MapSummary {
  int id = 0;
  int keyframes = 0, landmarks = 0;
  double first_timestamp = 0.0, last_timestamp = 0.0;  ///< seconds, of its keyframes
};

/// Maps that have keyframes, by id.
std::vector<MapSummary> summaries_of(const Map& map);

/// What a file holds, in lines to read.
std::string map_text(const StoredMap& stored);
/// The same for programs.
nlohmann::ordered_json map_json(const StoredMap& stored);

/// Keyframes of one map by their time stamps, of equal ones the earlier keyframe first.
Trajectory keyframes_of(const Map& map, int id);

}  // namespace dkp_slam::apps

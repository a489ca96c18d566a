#pragma once

#include <string>

#include "dkp_slam/map/map.h"

namespace dkp_slam {

/// Id of the map that a landmark lies in.
int map_of_landmark(const Map& map, int landmark);

/// All landmarks as a point cloud, ASCII PLY: x, y, z in metres in the world frame of their map,
/// and the map's id.
std::string landmarks_ply(const Map& map);

}  // namespace dkp_slam

#pragma once

#include <cstdint>
#include <filesystem>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/dense/free_space.h"
#include "dkp_slam/dense/level_frame.h"
#include "dkp_slam/dense/surface_mesh.h"

namespace dkp_slam {

/// Grey levels of ROS's map_server in its mode trinary.
enum class GridCell : std::uint8_t { occupied = 0, unknown = 205, free = 254 };

/// The static world seen from above.
struct OccupancyGrid {
  cv::Mat cells;             ///< CV_8UC1 of GridCell; the top row is that of the largest y
  double resolution = 0.05;  ///< metres from cell to cell
  Eigen::Vector2d origin =
      Eigen::Vector2d::Zero();  ///< lower left corner, x and y in the level frame
  Se3 level_from_world;
};

struct GridOptions {
  double low = 0.1, high = 1.8;  ///< metres above the floor: what a robot might run into
  double cell = 0.05;            ///< metres
};

/// A cell is occupied where a surface lies in the band of heights, else free where views looked
/// through any of that band, else unknown. Throws `Error` for a band or cell that makes no sense,
/// and where nothing was seen in the band.
OccupancyGrid make_grid(const SurfaceMesh& mesh, const FreeSpace& free, const LevelFrame& level,
                        const GridOptions& options = {});

/// Writes FILE.pgm and beside it FILE.yaml, as ROS's map_server reads them; the YAML file last,
/// each whole or not at all. Throws `Error`.
void write_grid(const std::filesystem::path& pgm, const OccupancyGrid& grid);

}  // namespace dkp_slam

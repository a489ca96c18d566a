#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/layout/image_folder.h"

namespace dkp_slam::apps {

/// What the user wants of the static world, and how it is to be made.
struct DenseExport {
  std::filesystem::path cloud, mesh, grid, octomap;  ///< files; empty for none
  std::filesystem::path sequence;                    ///< empty: the one that the run names
  std::string camera;
  std::string topics;                    ///< of a bag; empty: as for the run
  double frame_rate = usual_frame_rate;  ///< Hz, of a folder without time stamps
  std::filesystem::path masks;           ///< empty: those that the run kept
  bool no_masks = false;                 ///< fuse all pixels
  int every = 1;                         ///< localised frames from one that is fused to the next
  DepthViewOptions view;
  DenseMapOptions map;
  SurfaceOptions surface;
  GridOptions band;

  /// Whether any file is asked for.
  bool any() const { return !cloud.empty() || !mesh.empty() || !grid.empty() || !octomap.empty(); }
  /// Throws `Error` where a file could not be written now, and CLI::ValidationError where its name
  /// does not tell what it is.
  void check_files() const;
};

void add_dense_options(CLI::App& command, DenseExport& dense);

/// Fuses the images of a sequence at the poses of `path` and writes the files. `run`: the folder of
/// the run, which holds the masks and names the sequence; empty for none. Throws `Error`.
void export_dense(const DenseExport& dense, const std::filesystem::path& run,
                  const Trajectory& path);

}  // namespace dkp_slam::apps

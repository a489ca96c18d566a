#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/free_space.h"
#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam::apps {

/// Which files of the static world the user wants, and how it is to be made.
struct DenseFiles {
  std::filesystem::path cloud, mesh, grid, octomap;  ///< empty for none
  DepthViewOptions view;
  DenseMapOptions map;
  SurfaceOptions surface;
  GridOptions band;

  /// Whether any file is asked for.
  bool any() const { return !cloud.empty() || !mesh.empty() || needs_free_space(); }
  bool needs_free_space() const { return !grid.empty() || !octomap.empty(); }
  /// Throws `Error` where a file could not be written now, and CLI::ValidationError where its name
  /// does not tell what it is.
  void check() const;
};

/// --dense, --mesh, --grid, --octomap, and how they are made.
void add_dense_file_options(CLI::App& command, DenseFiles& files);

/// Extracts the surface, writes the files that are wanted, and says on the standard output what
/// they hold. `free`: null where none of them needs it; `path`: of the camera; `images`: that were
/// fused. Throws `Error`.
void write_dense_files(const DenseFiles& files, const DenseMap& map, const FreeSpace* free,
                       const Trajectory& path, std::size_t images);

}  // namespace dkp_slam::apps

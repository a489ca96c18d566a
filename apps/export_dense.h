#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/dense_files.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/layout/image_folder.h"

namespace dkp_slam::apps {

/// What the user wants of the static world, and what it is made of.
struct DenseExport : DenseFiles {
  std::filesystem::path sequence;  ///< empty: the one that the run names
  std::string camera;
  std::string topics;                    ///< of a bag; empty: as for the run
  double frame_rate = usual_frame_rate;  ///< Hz, of a folder without time stamps
  std::filesystem::path masks;           ///< empty: those that the run kept
  bool no_masks = false;                 ///< fuse all pixels
  int every = 1;                         ///< localised frames from one that is fused to the next
};

void add_dense_options(CLI::App& command, DenseExport& dense);

/// Fuses the images of a sequence at the poses of `path` and writes the files. `run`: the folder of
/// the run, which holds the masks and names the sequence; empty for none. Throws `Error`.
void export_dense(const DenseExport& dense, const std::filesystem::path& run,
                  const Trajectory& path);

}  // namespace dkp_slam::apps

#pragma once

#include <filesystem>

#include "dkp_slam/dense/free_space.h"
#include "dkp_slam/dense/surface_mesh.h"

namespace dkp_slam {

/// Whether the program was built with OctoMap (Hornung et al., Autonomous Robots 2013).
bool has_octomap();
/// Throws `Error`, which says what to install, unless it was.
void check_octomap();

/// Writes an octree of what is occupied and what is free (.bt, as octovis and octomap_server read
/// it), leaves as large as the cells of `free`, in the world frame of the trajectory; occupied is
/// where a vertex of the mesh lies. Whole or not at all. Throws `Error`, also for a mesh without
/// vertices.
void write_octomap(const std::filesystem::path& file, const SurfaceMesh& mesh,
                   const FreeSpace& free);

}  // namespace dkp_slam

#pragma once

#include <filesystem>

#include "dkp_slam/dense/surface_mesh.h"

namespace dkp_slam {

/// Binary PLY: position, normal and colour of each vertex; with `triangles` the faces, too, else a
/// point cloud. Whole or not at all. Throws `Error`, also for a mesh without vertices.
void write_mesh_ply(const std::filesystem::path& file, const SurfaceMesh& mesh, bool triangles);

/// Binary glTF 2.0 (.glb), turned to its axes (y up, z towards the viewer) as if the first camera
/// was held upright. Whole or not at all. Throws `Error`, also for a mesh without triangles.
void write_mesh_glb(const std::filesystem::path& file, const SurfaceMesh& mesh);

}  // namespace dkp_slam

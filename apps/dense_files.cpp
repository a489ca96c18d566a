#include "apps/dense_files.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/dense/mesh_files.h"
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

void warn_of_memory(const DenseMap& map, const FreeSpace* free) {
  if (map.full() || (free && free->full())) {
    spdlog::warn(
        "the memory of {:.0f} MB is used up: a part of the static world is missing; take larger "
        "voxels (--voxel), a shorter --range, or more --memory",
        map.options().memory);
  }
}

void write_files(const DenseFiles& files, const SurfaceMesh& mesh, const FreeSpace* free,
                 const Trajectory& path) {
  if (!files.cloud.empty()) write_mesh_ply(files.cloud, mesh, false);
  if (!files.mesh.empty()) {
    if (files.mesh.extension() == ".glb") {
      write_mesh_glb(files.mesh, mesh);
    } else {
      write_mesh_ply(files.mesh, mesh, true);
    }
  }
  if (!files.grid.empty()) {
    const LevelFrame level = find_level(mesh, path);
    if (!level.found) {
      spdlog::warn("no floor was seen: the grid's 0 is the lowest surface, its up the camera's");
    }
    write_grid(files.grid, make_grid(mesh, *free, level, files.band));
  }
  if (!files.octomap.empty()) write_octomap(files.octomap, mesh, *free);
}

}  // namespace

void DenseFiles::check() const {
  const auto check = [](const fs::path& file, const char* option,
                        const std::vector<std::string>& endings) {
    if (file.empty()) return;
    if (std::find(endings.begin(), endings.end(), file.extension()) == endings.end()) {
      throw CLI::ValidationError(
          option, fmt::format("{}: must end in {}", file.string(), fmt::join(endings, " or ")));
    }
    check_writable(file);
  };
  check(cloud, "--dense", {".ply"});
  check(mesh, "--mesh", {".ply", ".glb"});
  check(grid, "--grid", {".pgm"});
  check(octomap, "--octomap", {".bt"});
  if (!octomap.empty()) check_octomap();
}

void write_dense_files(const DenseFiles& files, const DenseMap& map, const FreeSpace* free,
                       const Trajectory& path, std::size_t images) {
  warn_of_memory(map, free);
  const SurfaceMesh mesh = extract_surface(map, files.surface);
  write_files(files, mesh, free, path);
  std::fputs(
      fmt::format("{} images fused at {:g} m: {} points, {} triangles; {:.0f} MB\n", images,
                  files.map.voxel, mesh.vertices.size(), mesh.triangles.size(), map.megabytes())
          .c_str(),
      stdout);
}

void add_dense_file_options(CLI::App& command, DenseFiles& files) {
  const std::string group = "Static world";
  const auto add = [&](const std::string& name, auto& variable, const std::string& help) {
    return command.add_option(name, variable, help)->group(group);
  };
  add("--dense", files.cloud, "File for a coloured point cloud, a point a voxel (.ply)");
  add("--mesh", files.mesh, "File for a coloured mesh (.ply or .glb)");
  add("--grid", files.grid,
      "File for a 2-D occupancy grid (.pgm; its .yaml comes beside it, for ROS's map_server)");
  add("--octomap", files.octomap, "File for an OctoMap octree (.bt)");
  add("--voxel", files.map.voxel, "Metres from sample to sample")
      ->check(CLI::Range(0.005, 0.2))
      ->capture_default_str();
  add("--range", files.view.max_range, "Metres; what is farther is left out")
      ->check(CLI::Range(0.5, 100.0))
      ->capture_default_str();
  add("--memory", files.map.memory, "Megabytes of voxels at most")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  add("--cell", files.band.cell, "Metres, of grid and octree")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  add("--low", files.band.low, "Of the grid: metres above the floor where its band begins")
      ->check(CLI::Range(-100.0, 100.0))
      ->capture_default_str();
  add("--high", files.band.high, "Of the grid: where it ends")
      ->check(CLI::Range(-100.0, 100.0))
      ->capture_default_str();
}

}  // namespace dkp_slam::apps

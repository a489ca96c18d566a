#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/dense/level_frame.h"
#include "dkp_slam/dense/mesh_files.h"
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/error.h"
#include "python/src/bindings.h"
#include "python/src/dense_object.h"
#include "python/src/frame_input.h"
#include "python/src/frames.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

/// dkp_slam.Surface.
struct SurfaceObject {
  std::shared_ptr<const SurfaceMesh> mesh;
};

/// dkp_slam.OccupancyGrid.
struct GridObject {
  OccupancyGrid grid;
};

/// Three numbers a row, no copy, read only.
template <class Number, class Row>
py::array rows_of(const SurfaceObject& self, const std::vector<Row>& rows) {
  using Owner = std::shared_ptr<const SurfaceMesh>;
  const py::capsule owner(new Owner(self.mesh), [](void* p) { delete static_cast<Owner*>(p); });
  constexpr auto size = static_cast<py::ssize_t>(sizeof(Number));
  static_assert(sizeof(Row) == 3 * sizeof(Number));
  py::array_t<Number> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}},
                            {3 * size, size}, reinterpret_cast<const Number*>(rows.data()), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

void need_ending(const fs::path& file, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    if (file.extension() == ending) return;
  }
  value_error(fmt::format("{}: must end in {}", file.string(), fmt::join(endings, " or ")));
}

void save_mesh(const SurfaceObject& self, const fs::path& file) {
  need_ending(file, {".ply", ".glb"});
  const py::gil_scoped_release release;
  if (file.extension() == ".glb") {
    write_mesh_glb(file, *self.mesh);
  } else {
    write_mesh_ply(file, *self.mesh, true);
  }
}

void save_cloud(const SurfaceObject& self, const fs::path& file) {
  need_ending(file, {".ply"});
  const py::gil_scoped_release release;
  write_mesh_ply(file, *self.mesh, false);
}

SurfaceObject surface_of(DenseReader& self, std::optional<int> map) {
  const py::gil_scoped_release release;
  auto mesh = std::make_shared<SurfaceMesh>();
  self.look(map, [&](const DenseMap& fused, const FreeSpace*, const Trajectory&) {
    *mesh = extract_surface(fused, self.surface());
  });
  return {std::move(mesh)};
}

/// Uses surface and free space where there are any.
template <class Use>
void with_free_space(DenseReader& self, std::optional<int> map, const Use& use) {
  const py::gil_scoped_release release;
  const bool there =
      self.look(map, [&](const DenseMap& fused, const FreeSpace* free, const Trajectory& path) {
        use(extract_surface(fused, self.surface()), *free, path);
      });
  if (!there) throw Error("nothing is fused yet: there is no static world to be written");
}

GridObject grid_of(DenseReader& self, double low, double high, std::optional<int> map) {
  if (!(low < high)) value_error(fmt::format("low is {}, high {}; low must be less", low, high));
  GridObject out;
  with_free_space(self, map,
                  [&](const SurfaceMesh& mesh, const FreeSpace& free, const Trajectory& path) {
                    GridOptions band;
                    band.low = low;
                    band.high = high;
                    band.cell = free.cell();
                    out.grid = make_grid(mesh, free, find_level(mesh, path), band);
                  });
  return out;
}

void save_octomap(DenseReader& self, const fs::path& file, std::optional<int> map) {
  need_ending(file, {".bt"});
  check_octomap();
  with_free_space(self, map,
                  [&](const SurfaceMesh& mesh, const FreeSpace& free, const Trajectory&) {
                    write_octomap(file, mesh, free);
                  });
}

using Work = void (FusedReader::*)(const RgbdFrame&, const Se3&);

/// `pose` by name, for images of Python's.
template <Work work>
void take_images(FusedReader& self, py::object rgb, py::object depth, const py::object& pose,
                 py::object mask, const std::string& order, std::optional<double> depth_scale) {
  const Se3 world_from_camera = pose_of("pose", pose);
  const RgbdFrame frame = frame_of(
      {std::move(rgb), std::move(depth), std::move(mask), 0.0, order, depth_scale, 0.0, false},
      self.camera());
  const py::gil_scoped_release release;
  (self.*work)(frame, world_from_camera);
}

template <Work work>
void take_frame(FusedReader& self, const FrameObject& object, const py::object& pose,
                const py::object& mask) {
  const Se3 world_from_camera = pose_of("pose", pose);
  RgbdFrame frame = object.frame;
  if (!mask.is_none()) {
    frame.mask = borrow("mask", array_named("mask", mask), CV_8UC1,
                        "bool or uint8 of shape (height, width), 0 on what is static");
  }
  const py::gil_scoped_release release;
  (self.*work)(frame, world_from_camera);
}

std::unique_ptr<FusedReader> make_map(const Camera& camera, double voxel, double range, double cell,
                                      double memory) {
  const DenseSettings settings{voxel, range, cell, memory};
  settings.check();
  if (const auto problem = camera.check()) value_error("Camera: " + *problem);
  return std::make_unique<FusedReader>(camera, settings);
}

void bind_surface(py::module_& module) {
  py::class_<SurfaceObject>(module, "Surface",
                            R"(The static world as points, and as triangles between them.

Metres, in the world frame of the poses. The arrays are no copies and read only.)")
      .def_property_readonly(
          "points", [](const SurfaceObject& s) { return rows_of<float>(s, s.mesh->vertices); },
          "(n, 3) float32, metres.")
      .def_property_readonly(
          "normals", [](const SurfaceObject& s) { return rows_of<float>(s, s.mesh->normals); },
          "(n, 3) float32, of length 1, into free space.")
      .def_property_readonly(
          "colours",
          [](const SurfaceObject& s) { return rows_of<std::uint8_t>(s, s.mesh->colours); },
          "(n, 3) uint8, RGB.")
      .def_property_readonly(
          "triangles", [](const SurfaceObject& s) { return rows_of<int>(s, s.mesh->triangles); },
          "(m, 3) int32, rows of points, counter-clockwise seen from free space.")
      .def("save_cloud", &save_cloud, py::arg("file"), R"(Writes the points as a PLY file.

Raises ValueError for another ending, Error where there is no point or the file cannot be written;
what was there then stays.)")
      .def("save_mesh", &save_mesh, py::arg("file"),
           R"(Writes the triangles, as .ply or as .glb (turned to y up).

Raises as save_cloud.)")
      .def("__len__", [](const SurfaceObject& s) { return s.mesh->vertices.size(); })
      .def("__repr__", [](const SurfaceObject& s) {
        return fmt::format("<dkp_slam.Surface {} points, {} triangles>", s.mesh->vertices.size(),
                           s.mesh->triangles.size());
      });
}

void bind_grid(py::module_& module) {
  py::class_<GridObject>(module, "OccupancyGrid",
                         R"(The static world from above, as ROS's map_server has it.)")
      .def_property_readonly(
          "cells", [](const GridObject& g) { return array_of(g.grid.cells); },
          "(rows, columns) uint8, no copy: 0 occupied, 254 free, 205 unknown; the top row is that "
          "of the largest y.")
      .def_property_readonly(
          "resolution", [](const GridObject& g) { return g.grid.resolution; },
          "Metres from cell to cell.")
      .def_property_readonly(
          "origin",
          [](const GridObject& g) { return std::pair(g.grid.origin.x(), g.grid.origin.y()); },
          "x and y of the lower left corner in the level frame, metres.")
      .def_property_readonly(
          "level_from_world",
          [](const GridObject& g) { return matrix_of(g.grid.level_from_world); },
          "4 x 4: to the frame that stands upright on the floor, z up.")
      .def(
          "save",
          [](const GridObject& g, const fs::path& file) {
            need_ending(file, {".pgm"});
            write_grid(file, g.grid);
          },
          py::arg("file"), R"(Writes FILE.pgm and FILE.yaml beside it, for map_server.

Raises ValueError for another ending, Error where they cannot be written.)")
      .def("__repr__", [](const GridObject& g) {
        return fmt::format("<dkp_slam.OccupancyGrid {} x {} cells of {:g} m>", g.grid.cells.cols,
                           g.grid.cells.rows, g.grid.resolution);
      });
}

/// What a dense map of either kind answers.
template <class Class>
void bind_reading(Class& dense) {
  dense
      .def("surface", &surface_of, py::arg("map") = py::none(),
           R"(The surface as it is fused now, without points where nothing is.

map: of a run with several; None: the one with the most keyframes.)")
      .def("grid", &grid_of, py::arg("low") = 0.1, py::arg("high") = 1.8,
           py::arg("map") = py::none(),
           R"(The floor plan: what lies from low to high metres above the floor.

Raises ValueError for a band that is none, Error where nothing was seen in it.)")
      .def("save_octomap", &save_octomap, py::arg("file"), py::arg("map") = py::none(),
           R"(Writes occupied and free leaves as an OctoMap tree (.bt).

Raises ValueError for another ending, Error where the module was built without OctoMap or nothing
is fused.)");
}

}  // namespace

void bind_dense(py::module_& module) {
  bind_surface(module);
  bind_grid(module);
  py::class_<DenseReader, std::shared_ptr<DenseReader>> reader(
      module, "_Dense", "What DenseMap and LiveDenseMap have in common.");
  bind_reading(reader);
  py::class_<FusedReader, DenseReader, std::shared_ptr<FusedReader>> fused(
      module, "DenseMap", R"(The static world, fused from depth images at known poses.

    dense = dkp_slam.DenseMap(camera, voxel=0.02)
    for frame, result in zip(frames, results):
        if result.localised:
            dense.fuse_frame(frame, result.pose, result.mask)
    dense.surface().save_mesh("room.glb")

What lies in masks is left out, what is looked through is carved away. voxel, range, cell (of grid
and octree): metres. memory: megabytes of voxels at most, and a quarter of it for free space. What
was fused does not move: for a run whose loops close later take the poses of the end, or
Slam.fuse_dense. Raises ValueError for what is out of bounds.)");
  fused.def(py::init(&make_map), py::arg("camera"), py::kw_only(), py::arg("voxel") = 0.02,
            py::arg("range") = 5.0, py::arg("cell") = 0.05, py::arg("memory") = 2000.0);
  const auto images = [&](const char* name, auto work, const char* help) {
    fused.def(name, work, py::arg("rgb"), py::arg("depth"), py::arg("pose"),
              py::arg("mask") = py::none(), py::kw_only(), py::arg("order") = "rgb",
              py::arg("depth_scale") = py::none(), help);
  };
  const auto frame = [&](const char* name, auto work, const char* help) {
    fused.def(name, work, py::arg("frame"), py::arg("pose"), py::arg("mask") = py::none(), help);
  };
  images("fuse", &take_images<&FusedReader::fuse>, R"(Fuses an image at its pose.

rgb, depth, order, depth_scale: as for Slam.feed. pose: world from camera, (4, 4), metres, when
depth was taken. mask: bool or uint8, (height, width), not 0 on what moves. Raises ValueError for
images that do not fit the camera and a pose that is no rigid motion.)");
  frame("fuse_frame", &take_frame<&FusedReader::fuse>,
        R"(The same for a frame of read_tum_folder or synth.

mask: None takes that of the frame, if it has one.)");
  images("reserve", &take_images<&FusedReader::reserve>,
         R"(Makes room for what an image shows, without fusing it.

Done for all images before the first is fused, a place also knows the views through it before
something appeared there, as `dkp-slam export` has it. Otherwise fuse makes room by itself.)");
  frame("reserve_frame", &take_frame<&FusedReader::reserve>,
        R"(The same for a frame of read_tum_folder or synth.

See reserve.)");
  fused.def("__len__", &FusedReader::images);
  py::class_<LiveReader, DenseReader, std::shared_ptr<LiveReader>>(
      module, "LiveDenseMap", R"(The static world of a run's keyframes, fused while it lasts.

Slam.fuse_dense makes it. A closed loop, a merge or an adjustment moves what was fused.)")
      .def_property_readonly(
          "version", [](const LiveReader& self) { return self.map()->version(); },
          "Rises with every change that is fused.")
      .def(
          "finish",
          [](const LiveReader& self) {
            const py::gil_scoped_release release;
            self.map()->finish();
          },
          R"(Waits until all that the run had is fused; after Slam.finish.

Raises Error where fusing has failed.)");
}

}  // namespace dkp_slam::python

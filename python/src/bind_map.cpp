#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/loop/map_merger.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/map_file/landmark_cloud.h"
#include "dkp_slam/map_file/map_file.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/map_object.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

MapObject load_map_object(const fs::path& file) {
  const py::gil_scoped_release release;
  return {std::make_shared<const Map>(read_map(file).map)};
}

void save(const MapObject& self, const fs::path& file) { save_map(file, *self.map); }

void save_landmarks(const MapObject& self, const fs::path& file) {
  if (self.map->live_landmarks() == 0) {
    throw Error("the map holds no landmark; there is nothing to be written");
  }
  write_file_atomically(file, landmarks_ply(*self.map));
}

std::pair<MapObject, py::list> merge(const MapObject& a, const MapObject& b) {
  std::optional<std::string> difference = difference_of(a.map->camera(), b.map->camera());
  if (!difference &&
      (a.map->level_scale() != b.map->level_scale() || a.map->levels() != b.map->levels())) {
    difference = fmt::format("{} pyramid levels there, {} here", b.map->levels(), a.map->levels());
  }
  if (difference) value_error("the maps were made with different cameras: " + *difference);
  MapParts parts_a = parts_of(*a.map), parts_b = parts_of(*b.map);
  MergedMap both = [&] {
    const py::gil_scoped_release release;
    return merge_maps(std::move(parts_a), std::move(parts_b));
  }();
  py::list joined;
  for (const JoinedMaps& j : both.joined) {
    py::dict pair;
    pair["kept"] = j.kept;
    pair["moved"] = j.moved;
    pair["keyframes"] = j.keyframes;
    joined.append(pair);
  }
  return {MapObject{std::make_shared<const Map>(std::move(both.map))}, joined};
}

std::vector<int> live_keyframes(const Map& map) {
  std::vector<int> ids;
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    if (!map.keyframe(k).removed) ids.push_back(k);
  }
  return ids;
}

/// One number each.
template <class Number, class Value>
py::array_t<Number> column(const std::vector<int>& ids, const Value& value) {
  py::array_t<Number> out(static_cast<py::ssize_t>(ids.size()));
  Number* to = out.mutable_data();
  for (const int id : ids) *to++ = static_cast<Number>(value(id));
  return out;
}

py::array_t<double> landmarks(const MapObject& self) {
  const std::vector<int> ids = self.map->landmarks();
  py::array_t<double> out({static_cast<py::ssize_t>(ids.size()), py::ssize_t{3}});
  double* to = out.mutable_data();
  for (const int id : ids) {
    for (const double value : self.map->landmark(id).position) *to++ = value;
  }
  return out;
}

py::object keyframes(const MapObject& self, int which) {
  Trajectory path;
  for (const int k : self.map->keyframes_in(which)) {
    const Keyframe& keyframe = self.map->keyframe(k);
    path.push_back({keyframe.timestamp, keyframe.camera_from_world.inverse()});
  }
  std::stable_sort(path.begin(), path.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.timestamp < b.timestamp;
  });
  return trajectory_object(path);
}

std::vector<int> maps(const MapObject& self) {
  std::set<int> ids;
  for (const int k : live_keyframes(*self.map)) ids.insert(self.map->keyframe(k).map);
  return {ids.begin(), ids.end()};
}

py::object keyframes_of(const MapObject& self, std::optional<int> which) {
  const std::vector<int> known = maps(self);
  if (!which && known.empty()) return trajectory_object({});
  if (which && std::find(known.begin(), known.end(), *which) == known.end()) {
    value_error(fmt::format("there is no map {}; its maps are {}", *which, fmt::join(known, ", ")));
  }
  if (which) return keyframes(self, *which);
  return keyframes(self, *std::max_element(known.begin(), known.end(), [&](int a, int b) {
                     return self.map->live_keyframes_in(a) < self.map->live_keyframes_in(b);
                   }));
}

}  // namespace

void bind_map(py::module_& module) {
  py::class_<MapObject>(module, "Map",
                        R"(Keyframes and landmarks, of a file or of a run that is finished.

It may hold several maps that never met, each in its own world frame. All arrays are copies.)")
      .def_static("load", &load_map_object, py::arg("file"),
                  "Reads a map file, whole. Raises Error where it is none or damaged.")
      .def("save", &save, py::arg("file"),
           "Makes a new map file. Raises Error where a file of that name is there already.")
      .def("save_landmarks", &save_landmarks, py::arg("file"),
           R"(Writes the landmarks as a point cloud (PLY, with the map of each).

Raises Error for a map without any, and where the file cannot be written.)")
      .def_property_readonly("camera", [](const MapObject& self) { return self.map->camera(); })
      .def_property_readonly("maps", &maps, "Ids of the maps in it.")
      .def_property_readonly("landmarks", &landmarks,
                             "Positions, metres, (n, 3), each in the world frame of its map.")
      .def_property_readonly(
          "landmark_ids",
          [](const MapObject& self) {
            return column<std::int64_t>(self.map->landmarks(), [](int id) { return id; });
          },
          "(n,): what Result.landmarks names.")
      .def_property_readonly(
          "landmark_maps",
          [](const MapObject& self) {
            return column<std::int64_t>(self.map->landmarks(),
                                        [&](int id) { return map_of_landmark(*self.map, id); });
          },
          "(n,): the map that each lies in.")
      .def_property_readonly(
          "landmark_sightings",
          [](const MapObject& self) {
            return column<std::int64_t>(self.map->landmarks(), [&](int id) {
              return self.map->landmark(id).sightings.size();
            });
          },
          "(n,): keyframes that see it.")
      .def_property_readonly(
          "keyframe_ids",
          [](const MapObject& self) {
            return column<std::int64_t>(live_keyframes(*self.map), [](int id) { return id; });
          },
          "(k,), of all maps.")
      .def("keyframes", &keyframes_of, py::arg("map") = py::none(),
           R"(The keyframes of one map as a Trajectory, by time; None: the map with most of them.

Raises ValueError for a map that there is not.)")
      .def("__repr__", [](const MapObject& self) {
        return fmt::format("<dkp_slam.Map {} keyframes, {} landmarks>", self.map->live_keyframes(),
                           self.map->live_landmarks());
      });
  module.def("merge_maps", &merge, py::arg("a"), py::arg("b"),
             R"(Both maps in a new one, and which of its maps were joined, as a list of dicts.

Maps that show the same place are joined (kept, moved: their numbers; keyframes: that agreed) and
adjusted; the others lie side by side, each in its own world frame. Raises ValueError for maps of
different cameras.)");
}

}  // namespace dkp_slam::python

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/sensor/tum_source.h"
#include "python/src/bindings.h"
#include "python/src/camera_files.h"
#include "python/src/frames.h"
#include "python/src/mailbox.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;

namespace {

/// dkp_slam.TumFolder.
struct FolderObject {
  Camera camera;
  std::unique_ptr<RgbdSource> source;
};

std::unique_ptr<FolderObject> open_folder(const fs::path& path, const std::optional<Camera>& camera,
                                          std::size_t first_frame, std::optional<std::size_t> count,
                                          const std::optional<fs::path>& masks,
                                          double max_difference) {
  auto folder = std::make_unique<FolderObject>();
  TumOptions options;
  options.first_frame = first_frame;
  options.frame_limit = count;
  options.masks = masks.value_or(fs::path());
  options.max_difference = max_difference;
  const py::gil_scoped_release release;
  folder->camera = camera ? *camera : camera_of_folder(path);
  folder->source = open_tum_folder(path.string(), folder->camera, options);
  return folder;
}

FrameObject next_frame(FolderObject& folder) {
  std::optional<RgbdFrame> frame;
  {
    const py::gil_scoped_release release;
    frame = folder.source->read();
  }
  deliver();
  if (!frame) throw py::stop_iteration();
  return {std::move(*frame)};
}

void bind_frame(py::module_& module) {
  py::class_<FrameObject>(module, "Frame", R"(A colour image with its depth, as the system reads it.

Slam.feed_frame takes it as it is.)")
      .def_property_readonly("index", [](const FrameObject& f) { return f.frame.index; })
      .def_property_readonly(
          "timestamp", [](const FrameObject& f) { return f.frame.timestamp; },
          "Seconds, the sensor's clock, of the colour image.")
      .def_property_readonly(
          "depth_delay", [](const FrameObject& f) { return f.frame.depth_delay; },
          "Seconds from the colour image to the depth image.")
      .def_property_readonly(
          "rgb", [](const FrameObject& f) { return rgb_of(f.frame.colour); },
          "Colour, uint8, (height, width, 3), RGB: a new array each time.")
      .def_property_readonly(
          "bgr", [](const FrameObject& f) { return array_of(f.frame.colour); },
          "The same in the order BGR, as it is stored: no copy, read only.")
      .def_property_readonly(
          "depth", [](const FrameObject& f) { return array_of(f.frame.depth); },
          "Depth, float32, (height, width), metres, 0 where unknown: no copy, read only.")
      .def_property_readonly(
          "mask",
          [](const FrameObject& f) -> py::object {
            if (f.frame.mask.empty()) return py::none();
            return array_of(f.frame.mask);
          },
          "Somebody's segmentation, uint8, (height, width), 0 on what is static, or None.")
      .def("__repr__", [](const FrameObject& f) {
        return fmt::format("<dkp_slam.Frame {} at {:.6f} s, {} x {}>", f.frame.index,
                           f.frame.timestamp, f.frame.colour.cols, f.frame.colour.rows);
      });
}

}  // namespace

void bind_frames(py::module_& module) {
  bind_frame(module);
  py::class_<FolderObject>(module, "TumFolder", R"(The frames of a folder, one after the other.

See read_tum_folder.)")
      .def_readonly("camera", &FolderObject::camera)
      .def_property_readonly(
          "skipped", [](const FolderObject& f) { return f.source->skipped(); },
          "Frames left out so far because an image could not be read.")
      .def("__len__", [](const FolderObject& f) { return f.source->size().value_or(0); })
      .def(
          "__iter__", [](FolderObject& f) -> FolderObject& { return f; },
          py::return_value_policy::reference_internal)
      .def("__next__", &next_frame);
  module.def("read_tum_folder", &open_folder, py::arg("path"), py::arg("camera") = py::none(),
             py::kw_only(), py::arg("first_frame") = 0, py::arg("count") = py::none(),
             py::arg("masks") = py::none(), py::arg("max_difference") = 0.02,
             R"(Iterates over the frames of a folder in the format of the TUM RGB-D benchmark.

camera: None takes camera.yaml of the folder, else what a benchmark's own folder name tells.
first_frame, count: leave frames out. masks: folder of somebody's segmentation, a PNG named like
each colour image. max_difference: seconds between a colour and a depth image that belong together.

Images that cannot be read are skipped with a warning and counted. Raises Error, which names the
file, where folder, list or camera are missing or do not fit.)");
}

}  // namespace dkp_slam::python

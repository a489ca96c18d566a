#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/error.h"
#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/synth/folder/synthetic_folder.h"
#include "dkp_slam/synth/source.h"
#include "dkp_slam/synth/true_detections.h"
#include "python/src/arrays.h"
#include "python/src/frames.h"

namespace dkp_slam::python {
namespace {

struct SyntheticFrameObject : FrameObject {
  SyntheticTruth truth;
};

/// dkp_slam.SyntheticSequence.
struct SequenceObject {
  explicit SequenceObject(const SyntheticOptions& options)
      : camera(options.camera), source(options) {}
  Camera camera;
  SyntheticSource source;
};

SyntheticOptions options_of(const std::string& scenario, std::optional<std::size_t> frames,
                            std::uint64_t seed, int width, int height, double rate, bool noise,
                            bool rolling_shutter) {
  constexpr double kinect_readout = 0.020;  // seconds
  if (width < 64 || width > 4096 || height < 64 || height > 4096) {
    value_error(
        fmt::format("{} x {} pixels: width and height must be from 64 to 4096", width, height));
  }
  if (!(rate >= 1.0 && rate <= 240.0)) {
    value_error(fmt::format("rate is {}; it must be from 1 to 240 frames a second", rate));
  }
  if (frames && *frames == 0) value_error("frames is 0; it must be at least 1");
  SyntheticOptions options = synthetic_scenario(scenario);
  options.seed = seed;
  options.kinect_noise = noise;
  options.camera = resized(options.camera, width, height);
  const double usual_rate = options.camera.frame_rate;
  options.camera.frame_rate = rate;
  options.frames = frames.value_or(static_cast<std::size_t>(
      std::lround(static_cast<double>(options.frames) * rate / usual_rate)));
  if (rolling_shutter) options.camera.readout = kinect_readout;
  return options;
}

std::unique_ptr<SequenceObject> make_sequence(const std::string& scenario,
                                              std::optional<std::size_t> frames, std::uint64_t seed,
                                              int width, int height, double rate, bool noise,
                                              bool rolling_shutter) {
  const SyntheticOptions options =
      options_of(scenario, frames, seed, width, height, rate, noise, rolling_shutter);
  const py::gil_scoped_release release;
  return std::make_unique<SequenceObject>(options);
}

/// Returns frames written; ends with what a signal raises, the frames before it listed.
std::size_t write_sequence(const std::filesystem::path& folder, const std::string& scenario,
                           std::optional<std::size_t> frames, std::uint64_t seed, int width,
                           int height, double rate, bool noise, bool rolling_shutter, bool force) {
  const SyntheticOptions options =
      options_of(scenario, frames, seed, width, height, rate, noise, rolling_shutter);
  bool interrupted = false;
  std::size_t written = 0;
  {
    const py::gil_scoped_release release;
    check_synthetic_folder(folder, force);
    SyntheticSource source(options);
    written = write_synthetic_folder(folder, options, source, [&](std::size_t) {
      const py::gil_scoped_acquire gil;
      interrupted = PyErr_CheckSignals() != 0;
      return !interrupted;
    });
  }
  if (interrupted) throw py::error_already_set();
  return written;
}

SyntheticFrameObject next_frame(SequenceObject& self) {
  SyntheticFrameObject out;
  {
    const py::gil_scoped_release release;
    if (auto frame = self.source.read()) {
      out.frame = std::move(*frame);
      out.truth = self.source.truth();
    }
  }
  if (out.frame.colour.empty()) throw py::stop_iteration();
  return out;
}

py::list detections(const SyntheticFrameObject& self) {
  const py::object make = py::module_::import("dkp_slam._core").attr("Detection");
  py::list out;
  for (const Detection& d : true_detections(self.truth)) {
    out.append(
        make(py::make_tuple(d.box.x, d.box.y, d.box.width, d.box.height), d.class_id, d.score));
  }
  return out;
}

py::object true_path(const SequenceObject& self) {
  Trajectory path;
  for (std::size_t i = 0; i < *self.source.size(); ++i) {
    const double t = self.source.timestamp(i);
    path.push_back({t, self.source.world_from_camera(t)});
  }
  return trajectory_object(path);
}

void bind_frame(py::module_& module) {
  py::class_<SyntheticFrameObject, FrameObject>(module, "SyntheticFrame",
                                                "A generated frame, with what is true of it.")
      .def_property_readonly(
          "true_pose",
          [](const SyntheticFrameObject& f) { return matrix_of(f.truth.world_from_camera); },
          "World from camera, 4 x 4 float64, metres, at the frame's time stamp.")
      .def_property_readonly(
          "true_depth", [](const SyntheticFrameObject& f) { return array_of(f.truth.depth); },
          "Float32, (height, width), metres, without noise, 0 where nothing is.")
      .def_property_readonly(
          "true_mask", [](const SyntheticFrameObject& f) { return array_of(f.truth.mask); },
          "Uint8, (height, width), 255 on people and on things that are moved at any time.")
      .def_property_readonly(
          "true_instances",
          [](const SyntheticFrameObject& f) { return array_of(f.truth.instance); },
          "Uint8, (height, width), 0 on the place itself, else the number of who or what it is.")
      .def_property_readonly("true_detections", &detections,
                             "What a perfect detector says: exact boxes, score 1.");
}

}  // namespace
}  // namespace dkp_slam::python

PYBIND11_MODULE(_synth, module) {
  using namespace dkp_slam::python;
  module.doc() = "The generated world; use it through dkp_slam.synth.";
  py::module_::import("dkp_slam._core");
  bind_frame(module);
  py::class_<SequenceObject>(module, "SyntheticSequence",
                             "The frames of a generated sequence, one after the other. See synth.")
      .def_readonly("camera", &SequenceObject::camera)
      .def_property_readonly("true_trajectory", &true_path, "Where the camera is at every frame.")
      .def("__len__", [](const SequenceObject& self) { return self.source.size().value_or(0); })
      .def(
          "__iter__", [](SequenceObject& self) -> SequenceObject& { return self; },
          py::return_value_policy::reference_internal)
      .def("__next__", &next_frame);
  module.def("synth", &make_sequence, py::arg("scenario") = "walking_xyz",
             py::arg("frames") = py::none(), py::kw_only(), py::arg("seed") = 1,
             py::arg("width") = 640, py::arg("height") = 480, py::arg("rate") = 30.0,
             py::arg("noise") = true, py::arg("rolling_shutter") = false,
             R"(Generates a sequence of furnished rooms with people in them, frame by frame.

The frames of `dkp-slam synth`, with what is true of them, and without files. scenario: one of
scenarios(). frames: None takes as many as it lasts. noise: a Kinect's. Raises ValueError and
Error for what makes no sequence.)");
  module.def("write_synth", &write_sequence, py::arg("folder"), py::arg("scenario") = "walking_xyz",
             py::arg("frames") = py::none(), py::kw_only(), py::arg("seed") = 1,
             py::arg("width") = 640, py::arg("height") = 480, py::arg("rate") = 30.0,
             py::arg("noise") = true, py::arg("rolling_shutter") = false, py::arg("force") = false,
             R"(Writes a generated sequence as a folder in the TUM benchmark's format.

The files of `dkp-slam synth`, to the byte: images, lists, camera.yaml, true path, masks and boxes.
The other arguments are those of synth. Returns the number of frames. The folder must be missing,
empty or hold a generated sequence, which is replaced; force: or anything else, which stays. Raises
ValueError and Error as synth, and Error where a file cannot be written.)");
  module.def(
      "scenarios",
      [] {
        py::dict out;
        for (const dkp_slam::ScenarioName& s : dkp_slam::scenario_names()) {
          out[py::str(s.name)] = s.description;
        }
        return out;
      },
      "Names of the scenarios, and what happens in each.");
}

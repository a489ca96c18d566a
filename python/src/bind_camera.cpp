#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/sequence_name.h"
#include "dkp_slam/sensor/camera_config.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/camera_files.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

using Coefficients = std::array<double, 5>;

Camera make_camera(int width, int height, double fx, double fy, double cx, double cy,
                   const Coefficients& distortion, double depth_scale, double min_depth,
                   double max_depth, double baseline, double frame_rate, double readout,
                   std::optional<double> depth_readout, std::string name) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  camera.distortion = {distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]};
  camera.depth_scale = depth_scale;
  camera.min_depth = min_depth;
  camera.max_depth = max_depth;
  camera.baseline = baseline;
  camera.frame_rate = frame_rate;
  camera.readout = readout;
  camera.depth_readout = depth_readout;
  camera.name = std::move(name);
  if (const auto problem = camera.check()) value_error("Camera: " + *problem);
  return camera;
}

/// One of the camera files that come with the package.
fs::path shipped_file(const std::string& name) {
  const auto module = py::module_::import("dkp_slam._core").attr("__file__").cast<fs::path>();
  return module.parent_path() / "config" / name;
}

/// Empty where `name` is none of those that come along.
fs::path file_by_short_name(const std::string& name) {
  if (name == "fr1" || name == "fr2" || name == "fr3") {
    return shipped_file(fmt::format("tum_{}.yaml", name));
  }
  return name == "bonn" ? shipped_file("bonn.yaml") : fs::path();
}

Camera load(const fs::path& file) {
  const fs::path known = file_by_short_name(file.string());
  if (known.empty() && !fs::is_regular_file(file)) {
    throw Error(fmt::format(
        "{}: no such camera file, nor one of fr1, fr2, fr3, bonn; check the path", file.string()));
  }
  return load_camera(known.empty() ? file.string() : known.string());
}

py::array_t<double> matrix(const Camera& camera) {
  py::array_t<double> out({3, 3});
  const cv::Matx33d values = camera.matrix();
  std::copy(std::begin(values.val), std::end(values.val), out.mutable_data());
  return out;
}

std::string text(const Camera& c) {
  return fmt::format("<dkp_slam.Camera {}{} x {}, fx {:g} fy {:g} cx {:g} cy {:g}>",
                     c.name.empty() ? "" : c.name + ": ", c.width, c.height, c.fx, c.fy, c.cx,
                     c.cy);
}

}  // namespace

Camera camera_of_folder(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error) throw Error(folder.string() + ": no such folder; check the path");
  if (fs::exists(real / "camera.yaml")) return load_camera((folder / "camera.yaml").string());
  std::string file;
  try {
    file = camera_file(real.filename());
  } catch (const Error&) {
    throw Error(
        fmt::format("{}: has no camera.yaml and its name does not tell its camera; pass camera=",
                    folder.string()));
  }
  return load_camera(shipped_file(file).string());
}

void bind_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera", R"(A pinhole RGB-D camera, depth registered to colour.

Pixels are (u, v), the centre of the top left pixel at (0, 0); camera axes are x right, y down,
z forward. Lengths in metres, focal lengths and principal point in pixels.

distortion: k1, k2, p1, p2, k3 as in OpenCV. depth_scale: units of a 16-bit depth image per metre.
min_depth, max_depth: depth outside is unknown. frame_rate: images per second. readout: seconds
from the first row's exposure to the last one's, 0 for a global shutter. depth_readout: the same of
the depth image; None: as readout, as in a Kinect.

depth_delay, depth_bias and depth_distortion of a camera file (load) say how its depth images are
off; TumFolder puts them right, Slam.feed takes depth as it comes.

Raises ValueError for numbers that make no camera.)")
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("fx"),
           py::arg("fy"), py::arg("cx"), py::arg("cy"), py::kw_only(),
           py::arg("distortion") = Coefficients{}, py::arg("depth_scale") = 5000.0,
           py::arg("min_depth") = 0.3, py::arg("max_depth") = 8.0, py::arg("baseline") = 0.075,
           py::arg("frame_rate") = 30.0, py::arg("readout") = 0.0,
           py::arg("depth_readout") = py::none(), py::arg("name") = "")
      .def_static("load", &load, py::arg("file"),
                  R"(The camera of a file (YAML), or one of "fr1", "fr2", "fr3", "bonn".

Raises Error, which names file, line and field.)")
      .def(
          "save", [](const Camera& c, const fs::path& file) { save_camera(c, file.string()); },
          py::arg("file"), "Writes a file that load() reads back exactly. Raises Error.")
      .def_readonly("name", &Camera::name)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_readonly("fx", &Camera::fx)
      .def_readonly("fy", &Camera::fy)
      .def_readonly("cx", &Camera::cx)
      .def_readonly("cy", &Camera::cy)
      .def_property_readonly("distortion",
                             [](const Camera& c) {
                               const Distortion& d = c.distortion;
                               return py::make_tuple(d.k1, d.k2, d.p1, d.p2, d.k3);
                             })
      .def_readonly("depth_scale", &Camera::depth_scale)
      .def_readonly("min_depth", &Camera::min_depth)
      .def_readonly("max_depth", &Camera::max_depth)
      .def_readonly("baseline", &Camera::baseline)
      .def_readonly("frame_rate", &Camera::frame_rate)
      .def_readonly("readout", &Camera::readout)
      .def_readonly("depth_readout", &Camera::depth_readout)
      .def_property_readonly(
          "depth_delay", [](const Camera& c) { return c.depth_correction.delay; },
          "Seconds by which depth is taken after its time stamp.")
      .def_property_readonly(
          "depth_bias", [](const Camera& c) { return c.depth_correction.bias; },
          "Metres to be added to each depth.")
      .def_property_readonly(
          "depth_distortion",
          [](const Camera& c) {
            const auto& d = c.depth_correction.distortion.coefficients;
            return std::vector<double>(d.begin(), d.end());
          },
          "1/metre, nine coefficients of what is to be added to inverse depths.")
      .def_property_readonly("matrix", &matrix, "The 3 x 3 matrix of the pinhole, float64.")
      .def("__repr__", &text);
}

}  // namespace dkp_slam::python

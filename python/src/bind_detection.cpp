#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/error.h"
#include "python/src/bindings.h"
#include "python/src/detectors.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

int class_of(const py::object& label) {
  if (py::isinstance<py::str>(label)) {
    const std::string name = py::str(label);
    if (name == "moving") return Detection::motion_class;
    if (const auto id = ClassTable::find(name)) return *id;
    value_error(
        fmt::format("label is '{}'; it must be a COCO class (\"person\", ...), its number, "
                    "or \"moving\" for what moves and has no name",
                    name));
  }
  if (!py::hasattr(label, "__index__")) {
    throw py::type_error("label must be the name of a COCO class or its number");
  }
  const int id = label.attr("__index__")().cast<int>();
  if (id == Detection::motion_class || (id >= 0 && id < ClassTable::class_count)) return id;
  value_error(
      fmt::format("label is {}; COCO classes run from 0 to {}", id, ClassTable::class_count - 1));
}

py::object checked_mask(const py::object& mask) {
  if (mask.is_none()) return mask;
  const py::array array = array_named("mask", mask);
  const char kind = array.dtype().kind();
  if (array.ndim() != 2 || array.itemsize() != 1 || (kind != 'b' && kind != 'u')) {
    value_error(
        fmt::format("mask is {}; it must be bool or uint8 of the image's shape (height, width)",
                    text_of(array)));
  }
  return array;
}

DetectionObject make_detection(const std::array<double, 4>& box, const py::object& label,
                               double score, const py::object& mask, std::optional<double> weight) {
  DetectionObject d;
  d.box = box;
  for (const double number : box) {
    if (!std::isfinite(number)) value_error("box holds a number that is not finite");
  }
  if (box[2] <= 0.0 || box[3] <= 0.0) {
    value_error(fmt::format(
        "box is ({:g}, {:g}, {:g}, {:g}); it must be (x, y, width, height), the last two above 0",
        box[0], box[1], box[2], box[3]));
  }
  d.class_id = class_of(label);
  if (!(score >= 0.0 && score <= 1.0)) {
    value_error(fmt::format("score is {}; it must be from 0 to 1", score));
  }
  d.score = score;
  d.weight = weight.value_or(ClassTable().weight(d.class_id));
  if (!(d.weight >= 1.0 && d.weight <= 10.0)) {
    value_error(fmt::format("weight is {}; it must be from 1 to 10", d.weight));
  }
  d.mask = checked_mask(mask);
  return d;
}

std::string label_of(const DetectionObject& d) { return std::string(ClassTable::name(d.class_id)); }

class Yolox final : public SharedDetector {
 public:
  using SharedDetector::SharedDetector;
};

class Recorded final : public SharedDetector {
 public:
  using SharedDetector::SharedDetector;
};

std::shared_ptr<Yolox> make_yolox(const std::optional<fs::path>& model,
                                  const std::optional<fs::path>& classes,
                                  const std::string& provider, int threads, double lowest_score) {
  YoloxOptions options;
  const auto file = find_model(model.value_or(fs::path()));
  if (!file) throw Error("no YOLOX model found; " + model_advice());
  options.model = *file;
  if (classes) options.classes = ClassTable::load(*classes);
  options.provider = provider;
  options.threads = threads;
  options.decode.lowest_score = static_cast<float>(lowest_score);
  const py::gil_scoped_release release;
  return std::make_shared<Yolox>(make_yolox_detector(options));
}

std::shared_ptr<Recorded> open_recorded(const fs::path& file,
                                        const std::optional<fs::path>& classes) {
  return std::make_shared<Recorded>(
      open_recorded_detections(file, classes ? ClassTable::load(*classes) : ClassTable()));
}

py::list detect(Yolox& self, const py::object& rgb) {
  const cv::Mat image =
      borrow("rgb", array_named("rgb", rgb), CV_8UC3, "uint8 of shape (height, width, 3)");
  RgbdFrame frame;
  std::vector<Detection> detections;
  {
    const py::gil_scoped_release release;
    cv::cvtColor(image, frame.colour, cv::COLOR_RGB2BGR);
    detections = self.detect(frame);
  }
  return detection_list(detections, image.size());
}

void bind_detection_object(py::module_& module) {
  py::class_<DetectionObject>(module, "Detection", R"(One detected object.

box: (x, y, width, height) in pixels of the colour image; what lies outside the image is cut off.
label: name or number of a COCO class, or "moving" for what moves and has no name. score: 0 to 1;
objects are started from 0.3 (option dynamics.compensation.start_score) and continued on less.
mask: the silhouette, bool or uint8 of the image's shape, not 0 on the object; it says that the
object moves by itself. weight: 1 (fixed, ignored) to 10 (a person); None: that of its class.

Raises ValueError for a box of no area, an unknown label, and numbers out of bounds.)")
      .def(py::init(&make_detection), py::arg("box"), py::arg("label"), py::arg("score"),
           py::arg("mask") = py::none(), py::arg("weight") = py::none())
      .def_property_readonly("box",
                             [](const DetectionObject& d) {
                               return py::make_tuple(d.box[0], d.box[1], d.box[2], d.box[3]);
                             })
      .def_property_readonly("label", &label_of)
      .def_readonly("class_id", &DetectionObject::class_id)
      .def_readonly("score", &DetectionObject::score)
      .def_readonly("weight", &DetectionObject::weight)
      .def_readonly("mask", &DetectionObject::mask)
      .def("__repr__", [](const DetectionObject& d) {
        return fmt::format("<dkp_slam.Detection {} {:.2f} at ({:.0f}, {:.0f}, {:.0f}, {:.0f}){}>",
                           label_of(d), d.score, d.box[0], d.box[1], d.box[2], d.box[3],
                           d.mask.is_none() ? "" : ", with mask");
      });
}

}  // namespace

void bind_detection(py::module_& module) {
  bind_detection_object(module);
  py::class_<SharedDetector, std::shared_ptr<SharedDetector>>(
      module, "Detector",
      "A detector that comes with the system; Slam takes it, and one calls at a time.")
      .def_property_readonly("name", &SharedDetector::name, "For reports.");
  py::class_<Yolox, SharedDetector, std::shared_ptr<Yolox>>(module, "Yolox",
                                                            R"(YOLOX, of any size.

model: an official export (.onnx); None: $DKP_SLAM_MODEL, models/, ~/.cache/dkp-slam. classes: file
of the classes' weights (config/classes.yaml). provider: "cpu", "cuda" or "tensorrt". lowest_score:
weaker boxes are dropped. Raises Error where there is no model or it is none.)")
      .def(py::init(&make_yolox), py::arg("model") = py::none(), py::kw_only(),
           py::arg("classes") = py::none(), py::arg("provider") = "cpu", py::arg("threads") = 1,
           py::arg("lowest_score") = 0.1)
      .def("detect", &detect, py::arg("rgb"),
           "Detections in one image: uint8, (height, width, 3), RGB.");
  py::class_<Recorded, SharedDetector, std::shared_ptr<Recorded>>(module, "RecordedDetections",
                                                                  R"(Repeats what a file says.

The detections.txt of an earlier run, of a generated sequence, or your own: a line each of
`timestamp class score x y width height`. Raises Error, which names file and line.)")
      .def(py::init(&open_recorded), py::arg("file"), py::arg("classes") = py::none());
}

}  // namespace dkp_slam::python

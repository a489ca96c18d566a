#include "python/src/detectors.h"

#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "python/src/mailbox.h"
#include "python/src/python_error.h"

namespace dkp_slam::python {
namespace {

class SharedDetectorUser final : public Detector {
 public:
  explicit SharedDetectorUser(std::shared_ptr<SharedDetector> detector)
      : detector_(std::move(detector)) {}
  std::string name() const override { return detector_->name(); }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    return detector_->detect(frame);
  }

 private:
  std::shared_ptr<SharedDetector> detector_;
};

/// A detector written in Python: called from the detector's thread, with the GIL.
class CallableDetector final : public Detector {
 public:
  CallableDetector(const py::object& callable, std::shared_ptr<DetectorFailure> failure)
      : callable_(callable.inc_ref().ptr()),
        failure_(std::move(failure)),
        name_(fmt::format("python ({})",
                          plain_text(py::hasattr(callable, "__name__")
                                         ? callable.attr("__name__")
                                         : py::type::of(callable).attr("__name__")))) {}
  ~CallableDetector() override { leave_reference(callable_); }
  CallableDetector(const CallableDetector&) = delete;
  CallableDetector& operator=(const CallableDetector&) = delete;

  std::string name() const override { return name_; }

  std::vector<Detection> detect(const RgbdFrame& frame) override {
    cv::Mat rgb;
    cv::cvtColor(frame.colour, rgb, cv::COLOR_BGR2RGB);
    const py::gil_scoped_acquire gil;
    try {
      return converted(py::handle(callable_)(array_of(rgb, true)), rgb.size());
    } catch (py::error_already_set& error) {
      throw Error(keep(error));
    } catch (const py::builtin_exception& error) {
      error.set_error();
      py::error_already_set raised;
      throw Error(keep(raised));
    }
  }

 private:
  std::string keep(const py::error_already_set& error) {
    if (failure_->exception == nullptr && error.value()) {
      const py::object value = error.value();
      if (error.trace()) PyException_SetTraceback(value.ptr(), error.trace().ptr());
      failure_->exception = py::object(value).release().ptr();
    }
    return line_of(error);
  }

  static std::vector<Detection> converted(const py::object& answer, const cv::Size& image) {
    if (answer.is_none()) {
      value_error("the detector returned None; return a list of Detection, empty for nothing");
    }
    std::vector<Detection> detections;
    for (const py::handle item : py::iter(answer)) {
      if (!py::isinstance<DetectionObject>(item)) {
        throw py::type_error(
            fmt::format("the detector returned a {} among its detections; each "
                        "must be a dkp_slam.Detection",
                        plain_text(py::type::of(item).attr("__name__"))));
      }
      Detection d = detection_of(item.cast<const DetectionObject&>(), image);
      if (d.box.area() > 0.0F) detections.push_back(std::move(d));
    }
    return detections;
  }

  PyObject* const callable_;
  const std::shared_ptr<DetectorFailure> failure_;
  const std::string name_;
};

/// The pixels that a box touches.
cv::Rect rounded_outwards(const cv::Rect2f& box) {
  const cv::Point first(static_cast<int>(std::floor(box.x)), static_cast<int>(std::floor(box.y)));
  const cv::Point end(static_cast<int>(std::ceil(box.x + box.width)),
                      static_cast<int>(std::ceil(box.y + box.height)));
  return {first, end};
}

DetectorKind kind_named(const std::string& name) {
  if (name == "auto") return DetectorKind::automatic;
  if (name == "yolox") return DetectorKind::yolox;
  if (name == "motion") return DetectorKind::motion;
  if (name == "none") return DetectorKind::none;
  value_error(fmt::format(
      "detector is '{}'; it must be one of config, auto, yolox, motion, none, or an object", name));
}

}  // namespace

DetectorFailure::~DetectorFailure() { leave_reference(exception); }

Detection detection_of(const DetectionObject& object, const cv::Size& image) {
  Detection detection;
  const auto at = [&](std::size_t i) { return static_cast<float>(object.box[i]); };
  detection.box = cv::Rect2f(at(0), at(1), at(2), at(3)) & cv::Rect2f({}, cv::Size2f(image));
  detection.class_id = object.class_id;
  detection.score = static_cast<float>(object.score);
  detection.weight = static_cast<float>(object.weight);
  if (object.mask.is_none() || detection.box.area() <= 0.0F) return detection;
  const auto mask = py::array::ensure(object.mask, py::array::c_style);
  if (mask.shape(0) != image.height || mask.shape(1) != image.width) {
    value_error(
        fmt::format("the mask of a detection is {}; it must be of the image's shape, ({}, {})",
                    text_of(mask), image.height, image.width));
  }
  const cv::Mat whole(image, CV_8UC1, const_cast<void*>(mask.data()));
  detection.mask = whole(rounded_outwards(detection.box) & cv::Rect({}, image)) != 0;
  return detection;
}

py::list detection_list(const std::vector<Detection>& detections, const cv::Size& image) {
  py::list out;
  for (const Detection& d : detections) {
    DetectionObject object;
    object.box = {d.box.x, d.box.y, d.box.width, d.box.height};
    object.class_id = d.class_id;
    object.score = d.score;
    object.weight = d.weight;
    if (!d.mask.empty()) {
      cv::Mat whole = cv::Mat::zeros(image, CV_8UC1);
      const cv::Rect at =
          cv::Rect(rounded_outwards(d.box).tl(), d.mask.size()) & cv::Rect({}, image);
      d.mask(cv::Rect({}, at.size())).copyTo(whole(at));
      object.mask = array_of(whole);
    }
    out.append(py::cast(std::move(object)));
  }
  return out;
}

std::unique_ptr<Detector> detector_of(const py::object& wanted, SlamConfig& config,
                                      const std::shared_ptr<DetectorFailure>& failure) {
  if (wanted.is_none() || !mode_info(config.dynamics.mode).detector) {
    config.detector.kind = DetectorKind::none;
    return nullptr;
  }
  if (py::isinstance<SharedDetector>(wanted)) {
    return std::make_unique<SharedDetectorUser>(wanted.cast<std::shared_ptr<SharedDetector>>());
  }
  if (py::isinstance<py::str>(wanted)) {
    const std::string name = py::str(wanted);
    if (name != "config") config.detector.kind = kind_named(name);
    const py::gil_scoped_release release;
    return make_detector(config.detector, config.camera);
  }
  if (PyCallable_Check(wanted.ptr()) == 0) {
    throw py::type_error(fmt::format(
        "detector is a {}; it must be None, a name, dkp_slam.Yolox, dkp_slam.RecordedDetections or "
        "a callable that takes an image",
        plain_text(py::type::of(wanted).attr("__name__"))));
  }
  return std::make_unique<CallableDetector>(wanted, failure);
}

}  // namespace dkp_slam::python

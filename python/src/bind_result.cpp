#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/error.h"
#include "python/src/bindings.h"
#include "python/src/session.h"

namespace dkp_slam::python {
namespace {

const char* name_of(TrackingState state) {
  switch (state) {
    case TrackingState::tracking:
      return "tracking";
    case TrackingState::lost:
      return "lost";
    default:
      return "not_initialized";
  }
}

const FrameDetails& details_of(const ResultObject& self) {
  if (self.details) return *self.details;
  throw Error(fmt::format(
      "frame {}: its mask and features were let go, as {} newer frames came before its result was "
      "taken; take results after every feed",
      self.result.index, Arrivals::most_kept));
}

py::object pose(const ResultObject& self) {
  if (!self.result.localised) return py::none();
  return matrix_of(self.result.world_from_camera);
}

py::array_t<double> covariance(const ResultObject& self) {
  const auto& values = self.result.quality.covariance;
  py::array_t<double> out({py::ssize_t{6}, py::ssize_t{6}});
  std::copy(values.data(), values.data() + values.size(), out.mutable_data());  // symmetric
  return out;
}

py::array mask(const ResultObject& self) {
  const FrameDetails& details = details_of(self);
  if (!details.mask.empty()) return array_of(details.mask);
  return array_of(cv::Mat::zeros(details.image, CV_8UC1));
}

py::array keypoints(const ResultObject& self) {
  const std::vector<cv::KeyPoint>& points = details_of(self).keypoints;
  py::array_t<float> out({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
  float* to = out.mutable_data();
  for (const cv::KeyPoint& point : points) {
    *to++ = point.pt.x;
    *to++ = point.pt.y;
  }
  return out;
}

py::array is_static(const ResultObject& self) {
  const std::vector<char>& values = details_of(self).is_static;
  py::array_t<bool> out(static_cast<py::ssize_t>(values.size()));
  std::transform(values.begin(), values.end(), out.mutable_data(), [](char v) { return v != 0; });
  return out;
}

py::array landmark_ids(const ResultObject& self) {
  const std::vector<int>& ids = details_of(self).landmarks;
  py::array_t<std::int64_t> out(static_cast<py::ssize_t>(ids.size()));
  std::copy(ids.begin(), ids.end(), out.mutable_data());
  return out;
}

py::list detections(const ResultObject& self) {
  const FrameDetails& details = details_of(self);
  return detection_list(details.detections.detections, details.image);
}

py::list objects(const ResultObject& self) {
  py::list out;
  for (const DynamicObject& object : details_of(self).objects) out.append(py::cast(object));
  return out;
}

py::dict times(const ResultObject& self) {
  const FrameResult& r = self.result;
  py::dict out;
  out["decode"] = r.decode_ms;
  out["feature"] = r.feature_ms;
  out["detection"] = r.detection_ms;
  out["clustering"] = r.clustering_ms;
  out["removal"] = r.removal_ms;
  out["tracking"] = r.tracking_ms;
  out["frame"] = r.frame_ms;
  out["latency"] = r.latency_ms;
  return out;
}

void bind_object(py::module_& module) {
  py::class_<DynamicObject>(module, "DynamicObject",
                            "An object that may move, followed over frames.")
      .def_readonly("id", &DynamicObject::id, "The same from frame to frame.")
      .def_property_readonly(
          "box",
          [](const DynamicObject& o) {
            return py::make_tuple(o.box.x, o.box.y, o.box.width, o.box.height);
          },
          "(x, y, width, height), pixels.")
      .def_property_readonly(
          "label", [](const DynamicObject& o) { return std::string(ClassTable::name(o.class_id)); })
      .def_readonly("class_id", &DynamicObject::class_id)
      .def_readonly("score", &DynamicObject::score, "Of its newest detection.")
      .def_readonly("compensated", &DynamicObject::compensated,
                    "Carried over from earlier frames, not detected in this one.")
      .def_readonly("mean_depth", &DynamicObject::mean_depth, "Metres, over its mask; 0: unknown.");
}

/// A field of FrameResult.
template <class Value>
auto field(Value FrameResult::*which) {
  return [which](const ResultObject& self) { return self.result.*which; };
}

}  // namespace

void bind_result(py::module_& module) {
  bind_object(module);
  py::class_<ResultObject>(module, "Result", "What became of one frame.")
      .def_property_readonly("index", field(&FrameResult::index), "From 0, as frames were fed.")
      .def_property_readonly("timestamp", field(&FrameResult::timestamp),
                             "Seconds, the frame's own.")
      .def_property_readonly(
          "state", [](const ResultObject& self) { return name_of(self.result.state); },
          "\"not_initialized\", \"tracking\" or \"lost\", after the frame.")
      .def_property_readonly("localised", field(&FrameResult::localised))
      .def_property_readonly("pose", &pose,
                             R"(World from camera, 4 x 4 float64, metres; None where not localised.

As known at that moment: later adjustments move it, see Slam.trajectory.)")
      .def_property_readonly("map", field(&FrameResult::map),
                             "Which of the maps the pose's world frame is of.")
      .def_property_readonly("keyframe", field(&FrameResult::keyframe), "Whether it became one.")
      .def_property_readonly("features", field(&FrameResult::features))
      .def_property_readonly("removed_features", field(&FrameResult::removed_features),
                             "Of these, called dynamic.")
      .def_property_readonly("tracked_landmarks", field(&FrameResult::tracked_landmarks),
                             "That the pose rests on; 0 where the measured motion carried it.")
      .def_property_readonly(
          "covariance", &covariance,
          R"(Of the pose, 6 x 6 float64: position (m^2), then orientation (rad^2).

Along the camera's axes; infinite where not localised. docs/reliability.md.)")
      .def_property_readonly(
          "people_share", [](const ResultObject& self) { return self.result.quality.people_share; },
          "Share of the image that lies on what may move, 0 to 1.")
      .def_property_readonly(
          "since_map_seen",
          [](const ResultObject& self) { return self.result.quality.since_map_seen; },
          "Seconds since landmarks of the map placed a frame; 0: this one; infinite: never.")
      .def_property_readonly("map_keyframes", field(&FrameResult::map_keyframes))
      .def_property_readonly("map_landmarks", field(&FrameResult::map_landmarks))
      .def_property_readonly("times", &times, "Milliseconds by stage.")
      .def_property_readonly("mask", &mask,
                             "What moves: uint8, (height, width), 255 on it, read only.")
      .def_property_readonly("keypoints", &keypoints,
                             "The features' pixels, (n, 2) float32, u and v of the image as fed.")
      .def_property_readonly("is_static", &is_static, "(n,) bool: which of them are used.")
      .def_property_readonly("landmarks", &landmark_ids,
                             "(n,): ids of the landmarks that they show, -1 for none.")
      .def_property_readonly("detections", &detections, "What the detector said of it.")
      .def_property_readonly("objects", &objects, "Objects that may move, in this frame.")
      .def("__repr__", [](const ResultObject& self) {
        return fmt::format("<dkp_slam.Result {} at {:.6f} s: {}, {} landmarks>", self.result.index,
                           self.result.timestamp, name_of(self.result.state),
                           self.result.tracked_landmarks);
      });
}

}  // namespace dkp_slam::python

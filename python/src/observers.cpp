#include "python/src/observers.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "dkp_slam/error.h"
#include "python/src/arrays.h"
#include "python/src/mailbox.h"
#include "python/src/python_error.h"

namespace dkp_slam::python {
namespace {

thread_local bool in_call = false;

/// A reference of our own, null for None.
PyObject* checked(const char* name, const py::object& callback) {
  if (callback.is_none()) return nullptr;
  if (PyCallable_Check(callback.ptr()) == 0) {
    throw py::type_error(
        fmt::format("{} is a {}; it must be a callable or None", name,
                    std::string(py::str(py::type::of(callback).attr("__name__")))));
  }
  return callback.ptr();
}

/// Calls it with what `argument` makes. Comes without the GIL.
template <class MakeArgument>
void call(PyObject* callback, const MakeArgument& argument) {
  if (callback == nullptr) return;
  const py::gil_scoped_acquire gil;
  in_call = true;
  std::string failure;
  try {
    const py::handle function(callback);
    function(argument());
  } catch (py::error_already_set& error) {
    failure = line_of(error);
  }
  in_call = false;
  if (!failure.empty()) throw Error(failure);
}

py::dict keyframe_dict(const KeyframeSnapshot& keyframe) {
  py::dict out;
  out["id"] = keyframe.id;
  out["map"] = keyframe.map;
  out["frame_index"] = keyframe.frame_index;
  out["timestamp"] = keyframe.timestamp;
  out["pose"] = matrix_of(keyframe.world_from_camera);
  out["landmarks"] = keyframe.landmarks;
  return out;
}

py::dict tracking_dict(const TrackingChange& change) {
  py::dict out;
  out["frame_index"] = change.frame_index;
  out["timestamp"] = change.timestamp;
  out["lost_for"] = change.lost_for;
  return out;
}

py::array_t<std::int64_t> ids_of(const std::vector<int>& ids) {
  py::array_t<std::int64_t> out(static_cast<py::ssize_t>(ids.size()));
  std::copy(ids.begin(), ids.end(), out.mutable_data());
  return out;
}

py::dict map_dict(const MapChange& change) {
  const auto keyframes = static_cast<py::ssize_t>(change.keyframes.size());
  const auto landmarks = static_cast<py::ssize_t>(change.landmarks.size());
  py::array_t<double> poses({keyframes, py::ssize_t{4}, py::ssize_t{4}});
  py::array_t<double> positions({landmarks, py::ssize_t{3}});
  std::vector<int> keyframe_ids, maps, landmark_ids;
  double* to = poses.mutable_data();
  constexpr py::ssize_t numbers = 16;
  for (const KeyframeState& k : change.keyframes) {
    keyframe_ids.push_back(k.id);
    maps.push_back(k.map);
    const py::array_t<double> matrix = matrix_of(k.camera_from_world.inverse());
    to = std::copy(matrix.data(), matrix.data() + numbers, to);
  }
  to = positions.mutable_data();
  for (const LandmarkState& l : change.landmarks) {
    landmark_ids.push_back(l.id);
    for (const double value : l.position) *to++ = value;
  }
  py::dict out;
  out["keyframe_ids"] = ids_of(keyframe_ids);
  out["keyframe_maps"] = ids_of(maps);
  out["keyframe_poses"] = poses;
  out["removed_keyframes"] = ids_of(change.removed_keyframes);
  out["landmark_ids"] = ids_of(landmark_ids);
  out["landmarks"] = positions;
  out["removed_landmarks"] = ids_of(change.removed_landmarks);
  return out;
}

}  // namespace

py::dict loop_dict(const ClosedLoop& loop) {
  py::dict out;
  out["keyframe"] = loop.keyframe;
  out["old_keyframe"] = loop.old_keyframe;
  out["matches"] = loop.matches;
  out["moved"] = loop.moved;
  out["joined_maps"] = loop.joined_maps;
  return out;
}

CallableObserver::CallableObserver(const Callbacks& callbacks)
    : keyframe_(checked("keyframe", callbacks.keyframe)),
      map_(checked("map", callbacks.map)),
      loop_(checked("loop", callbacks.loop)),
      merged_(checked("merged", callbacks.merged)),
      lost_(checked("lost", callbacks.lost)),
      found_(checked("found", callbacks.found)) {
  for (PyObject* callback : {keyframe_, map_, loop_, merged_, lost_, found_}) Py_XINCREF(callback);
}

CallableObserver::~CallableObserver() { let_go(); }

void CallableObserver::let_go() {
  for (PyObject** callback : {&keyframe_, &map_, &loop_, &merged_, &lost_, &found_}) {
    leave_reference(std::exchange(*callback, nullptr));
  }
}

void CallableObserver::on_keyframe(const KeyframeSnapshot& keyframe) {
  call(keyframe_, [&] { return keyframe_dict(keyframe); });
}

void CallableObserver::on_map(const MapChange& change) {
  call(map_, [&] { return map_dict(change); });
}

void CallableObserver::on_loop(const ClosedLoop& loop) {
  call(loop_, [&] { return loop_dict(loop); });
}

void CallableObserver::on_maps_merged(const ClosedLoop& loop) {
  call(merged_, [&] { return loop_dict(loop); });
}

void CallableObserver::on_lost(const TrackingChange& change) {
  call(lost_, [&] { return tracking_dict(change); });
}

void CallableObserver::on_found(const TrackingChange& change) {
  call(found_, [&] { return tracking_dict(change); });
}

bool CallableObserver::calling() { return in_call; }

}  // namespace dkp_slam::python

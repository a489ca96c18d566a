#include <fmt/format.h>
#include <pybind11/stl.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/system/scaled_config.h"
#include "python/src/bindings.h"
#include "python/src/config_object.h"
#include "python/src/dense_object.h"
#include "python/src/frame_input.h"
#include "python/src/frames.h"
#include "python/src/mailbox.h"
#include "python/src/map_object.h"
#include "python/src/session.h"

namespace dkp_slam::python {
namespace {

/// A copy that the system can go on with. Throws ValueError where it was made with another camera.
std::optional<Map> stored_map(const std::optional<MapObject>& wanted, const SlamConfig& config) {
  if (!wanted) return std::nullopt;
  const Map& map = *wanted->map;
  std::optional<std::string> difference = difference_of(map.camera(), config.camera);
  const int levels = scaled_to_camera(config).orb.levels;
  if (!difference && (map.level_scale() != config.orb.scale || map.levels() != levels)) {
    difference = fmt::format("{} pyramid levels there, {} here", map.levels(), levels);
  }
  if (difference) {
    value_error(fmt::format("map was made with another camera: {}; give that camera or another map",
                            *difference));
  }
  // Where many numbers are given to landmarks, they are counted anew.
  if (map.landmark_ids() >= most_landmark_ids / 10)
    return Map(with_new_landmark_ids(parts_of(map)));
  return map;
}

std::shared_ptr<Session> make_session(const ConfigObject& config, const py::object& detector,
                                      const std::optional<MapObject>& map) {
  SlamConfig used = config.config;
  if (const auto problem = used.camera.check()) value_error("Camera: " + *problem);
  if (used.localize_only && !map) value_error("localize_only needs a map; pass map=");
  try {
    used.check();
  } catch (const Error& error) {
    value_error(error.what());
  }
  auto failure = std::make_shared<DetectorFailure>();
  auto found = detector_of(detector, used, failure);
  auto stored = stored_map(map, used);
  deliver();
  return std::make_shared<Session>(used, std::move(found), std::move(stored), std::move(failure));
}

void feed(Session& self, py::object rgb, py::object depth, double t, py::object mask,
          const std::string& order, std::optional<double> depth_scale, double depth_delay,
          bool copy) {
  self.feed(frame_of(
      {std::move(rgb), std::move(depth), std::move(mask), t, order, depth_scale, depth_delay, copy},
      self));
}

void feed_frame(Session& self, const FrameObject& frame) {
  const std::optional<double>& last = self.last_timestamp();
  if (last && frame.frame.timestamp <= *last) {
    value_error(
        fmt::format("the frame's time stamp {:.6f} is not after the last one's {:.6f}; feed "
                    "frames in their order",
                    frame.frame.timestamp, *last));
  }
  self.feed(frame.frame);
}

py::list results(Session& self) {
  py::list out;
  while (auto result = self.poll()) out.append(py::cast(std::move(*result)));
  return out;
}

py::list trajectories(const Session& self) {
  py::list out;
  for (const Trajectory& t : self.finished_slam()->trajectories()) out.append(trajectory_object(t));
  return out;
}

py::list loops(const Session& self) {
  py::list out;
  for (const ClosedLoop& l : self.finished_slam()->loops()) out.append(loop_dict(l));
  return out;
}

void observe(Session& self, py::object keyframe, py::object map, py::object loop, py::object merged,
             py::object lost, py::object found, double map_interval) {
  if (!(map_interval >= 0.0)) {
    value_error(fmt::format("map_interval is {}; it must be 0 or more seconds", map_interval));
  }
  self.observe({std::move(keyframe), std::move(map), std::move(loop), std::move(merged),
                std::move(lost), std::move(found)},
               map_interval);
}

std::shared_ptr<LiveReader> fuse_dense(Session& self, double voxel, double range, double cell,
                                       double memory, int keyframes) {
  const DenseSettings settings{voxel, range, cell, memory};
  settings.check();
  if (keyframes < 2) value_error(fmt::format("keyframes is {}; it must be at least 2", keyframes));
  auto reader = std::make_shared<LiveReader>(self.config(), settings, keyframes);
  self.add_observer(reader->map(), LiveDenseMap::watching());
  return reader;
}

MapObject map_of(const Session& self) {
  const std::shared_ptr<Slam> slam = self.finished_slam();
  return {std::shared_ptr<const Map>(slam, &slam->map())};
}

/// Leaving a `with` block: an exception ends it at once.
void leave(Session& self, const py::object& type, const py::object&, const py::object&) {
  if (type.is_none() && !self.finished()) self.finish();
  if (!type.is_none()) self.close();
}

void bind_counters(py::module_& module) {
  py::class_<SlamCounters>(module, "Counters", "What a run came to so far.")
      .def_readonly("fed", &SlamCounters::fed)
      .def_readonly("answered", &SlamCounters::answered, "Frames that there is a result of.")
      .def_readonly("dropped", &SlamCounters::dropped, "Live: too late.")
      .def_readonly("detector_failures", &SlamCounters::detector_failures,
                    "1: it raised, and is not called any more; see Slam.detector_error.")
      .def_readonly("observer_exceptions", &SlamCounters::observer_exceptions,
                    "What callables of Slam.observe raised.")
      .def("__repr__", [](const SlamCounters& c) {
        return fmt::format("<dkp_slam.Counters fed {}, answered {}, dropped {}>", c.fed, c.answered,
                           c.dropped);
      });
}

using SlamClass = py::class_<Session, std::shared_ptr<Session>>;

void bind_way_in(SlamClass& slam) {
  slam.def("feed", &feed, py::arg("rgb"), py::arg("depth"), py::arg("t"),
           py::arg("mask") = py::none(), py::kw_only(), py::arg("order") = "rgb",
           py::arg("depth_scale") = py::none(), py::arg("depth_delay") = 0.0,
           py::arg("copy") = false, R"(Takes a frame.

rgb: uint8, (height, width, 3). The system works on BGR: order="rgb" converts into memory of its
own, order="bgr" takes the array as it is, without a copy. depth: registered to colour, (height,
width): float32 metres, 0 where unknown, without a copy (but where readings are NaN or outside the
camera's range: those become 0 in a copy); or uint16, converted by depth_scale, units per metre
(None: the camera's). t: seconds, later than the last frame's. mask: in mode "masks", bool or uint8,
(height, width), not 0 on what moves; without a copy. depth_delay: seconds from colour to depth.

What is taken without a copy must not be written to until the next frame's result is there, and live
not while the detector works on it: use copy=True where a buffer is used again. Offline it waits for
room, live it returns at once. Raises ValueError for images of another type or size, and time stamps
out of order; nothing has changed then.)")
      .def("feed_frame", &feed_frame, py::arg("frame"),
           "Takes a frame of read_tum_folder or synth, without a copy. Raises as feed.");
}

void bind_way_out(SlamClass& slam) {
  slam.def("poll", &Session::poll,
           "The next Result, in the frames' order; None when there is none yet.")
      .def("wait", &Session::wait, py::arg("timeout") = py::none(),
           R"(Waits for the next Result.

None when every frame fed so far has had its own, and after `timeout` seconds.)")
      .def("results", &results, "All results that are there, as a list.")
      .def("finish", &Session::finish,
           R"(No more frames: finishes those fed, and adjusts the map once more.

Results are still there to be taken. Ctrl-C leaves the adjustment out.)")
      .def("close", &Session::close, "Ends at once, and lets go of everything.")
      .def_property_readonly("counters", &Session::counters)
      .def_property_readonly("detector_name", &Session::detector_name)
      .def_property_readonly("detector_error", &Session::detector_error,
                             "What a detector written in Python raised, or None.")
      .def_property_readonly(
          "trajectory",
          [](const Session& self) { return trajectory_object(self.finished_slam()->trajectory()); },
          R"(After finish: world from camera for every localised frame, as a Trajectory.

With everything known at the end; of the longest path where there are several.)")
      .def_property_readonly("trajectories", &trajectories,
                             "After finish: one Trajectory per map, the longest first.")
      .def_property_readonly(
          "keyframe_trajectory",
          [](const Session& self) {
            return trajectory_object(self.finished_slam()->keyframe_trajectory());
          },
          "After finish: this run's keyframes in the map of the longest path.")
      .def_property_readonly("loops", &loops,
                             "After finish: loops closed and maps merged, as dicts.")
      .def_property_readonly("map", &map_of, "After finish: the Map.");
}

void bind_observers(SlamClass& slam) {
  slam.def("observe", &observe, py::kw_only(), py::arg("keyframe") = py::none(),
           py::arg("map") = py::none(), py::arg("loop") = py::none(),
           py::arg("merged") = py::none(), py::arg("lost") = py::none(),
           py::arg("found") = py::none(), py::arg("map_interval") = 0.5,
           R"(Calls callables with what happens, each with one dict. Before the first frame.

keyframe: one was inserted (id, map, frame_index, timestamp, pose, landmarks). map: keyframes and
landmarks that are new, moved or gone since the last call, at least map_interval seconds ago
(keyframe_ids, keyframe_maps, keyframe_poses (k, 4, 4), removed_keyframes, landmark_ids, landmarks
(n, 3), removed_landmarks). loop, merged: as in Slam.loops. lost, found: the camera (frame_index,
timestamp, lost_for in seconds).

They are called one at a time and in order, from a thread of their own. What they raise is logged
once and counted in counters.observer_exceptions; the run goes on. Offline the run waits for who is
64 events behind; live the oldest are left out. feed, wait, finish and close cannot be called in
them.)")
      .def("fuse_dense", &fuse_dense, py::kw_only(), py::arg("voxel") = 0.02,
           py::arg("range") = 5.0, py::arg("cell") = 0.05, py::arg("memory") = 2000.0,
           py::arg("keyframes") = 400,
           R"(Fuses the static world of the keyframes while the run lasts: a LiveDenseMap.

Before the first frame. voxel, range, cell (of grid and octree): metres. memory: megabytes of voxels
at most. keyframes: whose images are kept, about 0.5 MB each. Raises ValueError for what is out of
bounds.)");
}

}  // namespace

void bind_slam(py::module_& module) {
  bind_counters(module);
  bind_result(module);
  SlamClass slam(module, "Slam", R"(Colour and depth images in, camera poses and a map out.

    with dkp_slam.Slam(dkp_slam.Config(camera)) as slam:
        for rgb, depth, t in frames:
            slam.feed(rgb, depth, t)
            for result in slam.results():
                print(result.timestamp, result.pose)
    timestamps, poses = slam.trajectory

Leaving the block finishes, an exception in it closes. detector: None; "config" (what the
configuration's detector.kind says), "auto" (YOLOX where there is a model, else motion), "yolox",
"motion" or "none"; a Yolox or RecordedDetections; or a callable that takes an image (uint8,
(height, width, 3), RGB) and returns a list of Detection. It is called from a thread of its own,
offline with every frame in order; when it raises, that is logged and kept in detector_error, and
the run goes on without it. map: a Map to go on with, or, with localize_only, to find the camera in.

Feeding and finishing is one thread's at a time, taking results one's (the same or another).
Raises ValueError for a configuration that makes no sense, Error where a model is missing.)");
  slam.def(py::init(&make_session), py::arg("config"), py::arg("detector") = "config",
           py::arg("map") = py::none())
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", &leave, py::arg("type"), py::arg("value"), py::arg("traceback"))
      .def("__repr__", [](const Session& self) {
        const SlamCounters counters = self.counters();
        return fmt::format("<dkp_slam.Slam {} frames, detector {}>", counters.fed,
                           self.detector_name());
      });
  bind_way_in(slam);
  bind_way_out(slam);
  bind_observers(slam);
  module.def("_end", [] {
    Session::close_all();
    close_mailbox();
  });
}

}  // namespace dkp_slam::python

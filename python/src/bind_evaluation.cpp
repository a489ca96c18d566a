#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/relative_error.h"
#include "dkp_slam/export/path_formats.h"
#include "dkp_slam/export/trajectory.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

AbsoluteError ate(const py::object& truth, const py::object& estimate, double max_difference,
                  double offset) {
  return absolute_error(trajectory_of("truth", truth), trajectory_of("estimate", estimate),
                        {max_difference, offset});
}

StepUnit unit_named(const std::string& name) {
  for (const StepUnit unit : {StepUnit::seconds, StepUnit::frames, StepUnit::metres,
                              StepUnit::radians, StepUnit::degrees}) {
    if (short_name(unit) == name) return unit;
  }
  value_error(fmt::format("unit is '{}'; it must be one of s, f, m, rad, deg", name));
}

RelativeError rpe(const py::object& truth, const py::object& estimate, double delta,
                  const std::string& unit, bool all_pairs, std::size_t max_pairs, double offset) {
  if (!(delta > 0.0)) value_error(fmt::format("delta is {}; it must be above 0", delta));
  RelativeErrorOptions options;
  options.delta = delta;
  options.unit = unit_named(unit);
  options.all_pairs = all_pairs;
  options.max_pairs = max_pairs;
  options.offset = offset;
  return relative_error(trajectory_of("truth", truth), trajectory_of("estimate", estimate),
                        options);
}

py::array_t<double> errors(const AbsoluteError& e) {
  return py::array_t<double>(static_cast<py::ssize_t>(e.errors.size()), e.errors.data());
}

py::array_t<std::int64_t> matches(const AbsoluteError& e) {
  py::array_t<std::int64_t> out({static_cast<py::ssize_t>(e.matches.size()), py::ssize_t{2}});
  py::ssize_t i = 0;
  for (const PoseMatch& m : e.matches) {
    out.mutable_at(i, 0) = static_cast<std::int64_t>(m.truth);
    out.mutable_at(i++, 1) = static_cast<std::int64_t>(m.estimate);
  }
  return out;
}

/// A row per pair: from, to, translation, rotation.
py::array_t<double> samples(const RelativeError& e) {
  py::array_t<double> out({static_cast<py::ssize_t>(e.samples.size()), py::ssize_t{4}});
  double* row = out.mutable_data();
  for (const RelativeErrorSample& s : e.samples) {
    for (const double value : {s.from, s.to, s.translation, s.rotation}) *row++ = value;
  }
  return out;
}

/// By the file's ending where no name is given; whatever is no other is TUM.
PathFormat format_of(const std::optional<std::string>& name, const fs::path& file) {
  const std::string ending = file.extension();
  std::vector<std::string> names;
  for (const PathFormatInfo& f : path_formats()) {
    const bool told =
        name ? *name == f.name : !ending.empty() && std::string_view(f.ending).ends_with(ending);
    if (told) return f.format;
    names.emplace_back(f.name);
  }
  if (!name) return PathFormat::tum;
  value_error(fmt::format("format is '{}'; it must be one of {}", *name, fmt::join(names, ", ")));
}

void bind_statistics(py::module_& module) {
  py::class_<ErrorStatistics>(module, "ErrorStatistics",
                              "The benchmark's figures of a set of errors, in their unit.")
      .def_readonly("count", &ErrorStatistics::count)
      .def_readonly("rmse", &ErrorStatistics::rmse)
      .def_readonly("mean", &ErrorStatistics::mean)
      .def_readonly("median", &ErrorStatistics::median)
      .def_readonly("deviation", &ErrorStatistics::deviation)
      .def_readonly("min", &ErrorStatistics::min)
      .def_readonly("max", &ErrorStatistics::max)
      .def("__repr__", [](const ErrorStatistics& s) {
        return fmt::format(
            "<dkp_slam.ErrorStatistics rmse {:.6f}, median {:.6f}, max {:.6f}, of {}>", s.rmse,
            s.median, s.max, s.count);
      });
}

void bind_errors(py::module_& module) {
  py::class_<AbsoluteError>(module, "AbsoluteError",
                            "How far each position is from the truth, the paths laid over another.")
      .def_property_readonly("rmse", [](const AbsoluteError& e) { return e.statistics.rmse; })
      .def_readonly("statistics", &AbsoluteError::statistics, "Metres.")
      .def_property_readonly("errors", &errors, "Metres, (n,), one per match.")
      .def_property_readonly("matches", &matches,
                             "(n, 2): index in the truth, index in the estimate.")
      .def_property_readonly(
          "truth_from_estimate",
          [](const AbsoluteError& e) { return matrix_of(e.truth_from_estimate); },
          "4 x 4: the alignment, from the estimate's world frame to the truth's.")
      .def("__repr__", [](const AbsoluteError& e) {
        return fmt::format("<dkp_slam.AbsoluteError rmse {:.4f} m, {} poses>", e.statistics.rmse,
                           e.statistics.count);
      });
  py::class_<RelativeError>(module, "RelativeError", "Drift over a step.")
      .def_readonly("translation", &RelativeError::translation, "Metres.")
      .def_readonly("rotation", &RelativeError::rotation, "Radians.")
      .def_property_readonly("samples", &samples,
                             "(n, 4), a pair of poses each: from and to, seconds; metres; radians.")
      .def("__repr__", [](const RelativeError& e) {
        return fmt::format("<dkp_slam.RelativeError rmse {:.4f} m, {:.4f} rad, {} pairs>",
                           e.translation.rmse, e.rotation.rmse, e.translation.count);
      });
}

}  // namespace

void bind_evaluation(py::module_& module) {
  bind_statistics(module);
  bind_errors(module);
  module.def(
      "read_trajectory",
      [](const fs::path& file) { return trajectory_object(read_trajectory(file)); },
      py::arg("file"), R"(A trajectory in the TUM benchmark's format: `t x y z qx qy qz qw` a line.

Raises Error, which names file and line.)");
  module.def(
      "write_trajectory",
      [](const fs::path& file, const py::object& trajectory,
         const std::optional<std::string>& format) {
        write_path(format_of(format, file), file, trajectory_of("trajectory", trajectory));
      },
      py::arg("file"), py::arg("trajectory"), py::arg("format") = py::none(),
      R"(Writes a trajectory, a whole file or none.

format: "tum"; "kitti" (the 3 x 4 matrix of a pose a line); "euroc" (CSV: nanoseconds, position,
quaternion with w first); "ply" (positions, and edges between them); "gltf" (a line strip, turned
to y up). None: by the ending .csv, .ply or .gltf, else tum. Raises ValueError for another name,
Error for a trajectory without a pose and where the file cannot be written.)");
  module.def("ate", &ate, py::arg("truth"), py::arg("estimate"), py::kw_only(),
             py::arg("max_difference") = 0.02, py::arg("offset") = 0.0,
             R"(Absolute trajectory error, as the TUM benchmark's evaluate_ate.py has it.

truth, estimate: Trajectory, (timestamps, poses) or a file. max_difference: seconds between poses
that belong together. offset: seconds added to the estimate's stamps. Raises Error where fewer than
two poses match.)");
  module.def("rpe", &rpe, py::arg("truth"), py::arg("estimate"), py::arg("delta") = 1.0,
             py::arg("unit") = "s", py::kw_only(), py::arg("all_pairs") = false,
             py::arg("max_pairs") = 10000, py::arg("offset") = 0.0,
             R"(Relative pose error, as the TUM benchmark's evaluate_rpe.py has it.

delta: the step of the pairs in `unit`: "s" seconds, "f" frames, "m" metres, "rad" or "deg".
all_pairs: every pose with every other instead. max_pairs: more are sampled; 0: never. Raises Error
where fewer than two pairs can be compared.)");
}

}  // namespace dkp_slam::python

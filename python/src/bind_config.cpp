#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/config/option_list.h"
#include "dkp_slam/config/yaml/option_file.h"
#include "dkp_slam/error.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/config_object.h"

namespace dkp_slam::python {
namespace fs = std::filesystem;
namespace {

/// A value as a file has it.
std::string text_of_value(const std::string& name, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  const bool plain = py::isinstance<py::str>(value) || py::isinstance<py::int_>(value) ||
                     py::isinstance<py::float_>(value) || py::hasattr(value, "__fspath__") ||
                     py::hasattr(value, "__index__") || py::hasattr(value, "__float__");
  if (!plain) {
    throw py::type_error(fmt::format("{} must be a number, a bool or a text, not {}", name,
                                     std::string(py::str(py::type::of(value).attr("__name__")))));
  }
  return py::str(value);
}

Option& option_named(OptionList& list, const std::string& name) {
  if (Option* option = list.find(name)) return *option;
  throw py::key_error(
      fmt::format("there is no option {}; did you mean {}?", name, list.nearest(name)));
}

void set(SlamConfig& config, const std::string& name, const py::handle& value) {
  OptionList list = OptionList::of(config);
  Option& option = option_named(list, name);
  try {
    option.assign(text_of_value(name, value));
  } catch (const Error& error) {
    value_error(error.what());
  }
}

py::object get(SlamConfig& config, const std::string& name) {
  OptionList list = OptionList::of(config);
  return std::visit(
      [&](const auto& value) -> py::object {
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, Choice>) {
          return py::str(value.names.at(value.get()));
        } else if constexpr (std::is_same_v<Value, fs::path*>) {
          return py::str(value->string());
        } else {
          return py::cast(*value);
        }
      },
      option_named(list, name).value);
}

void check(SlamConfig& config) {
  try {
    config.check();
  } catch (const Error& error) {
    value_error(error.what());
  }
}

py::list names(SlamConfig& config) {
  py::list out;
  const OptionList list = OptionList::of(config);
  for (const Option& option : list.options()) out.append(option.name);
  return out;
}

std::string described(SlamConfig& config, const std::string& name) {
  OptionList list = OptionList::of(config);
  const Option& option = option_named(list, name);
  return fmt::format("{}{}; {}", option.unit.empty() ? "" : "[" + option.unit + "] ",
                     option.meaning, option.wanted());
}

ConfigObject make_config(const Camera& camera, const std::string& mode, bool realtime,
                         const py::object& options) {
  ConfigObject made;
  made.config.camera = camera;
  set(made.config, "mode", py::str(mode));
  made.config.realtime = realtime;
  if (options.is_none()) return made;
  for (const auto item : py::dict(options)) {
    set(made.config, py::str(item.first), item.second);
  }
  check(made.config);
  return made;
}

void read_file(ConfigObject& self, const fs::path& file) {
  SlamConfig read = self.config;
  OptionList list = OptionList::of(read);
  read_option_file(file, list);
  try {
    list.check();
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
  self.config = read;
}

}  // namespace

void bind_config(py::module_& module) {
  py::class_<ConfigObject>(module, "Config", R"(Everything that decides a run's result.

A mapping from the options' dotted names, those of `dkp-slam config` and `--set`, to their values:

    config = dkp_slam.Config(camera, mode="dkp+", options={"tracking.local_keyframes": 60})
    config["orb.features"] = 1500

mode: "off", "masks", "paper", "d", "dk", "dkp" or "dkp+". realtime: never wait, drop what comes too
fast. Raises KeyError for a name that there is not (the nearest one is told) and ValueError for a
value of the wrong type or out of bounds.)")
      .def(py::init(&make_config), py::arg("camera"), py::arg("mode") = "dkp+",
           py::arg("realtime") = false, py::arg("options") = py::none())
      .def_property(
          "camera", [](const ConfigObject& self) { return self.config.camera; },
          [](ConfigObject& self, const Camera& camera) { self.config.camera = camera; },
          "The camera: a copy.")
      .def(
          "__getitem__",
          [](ConfigObject& self, const std::string& name) { return get(self.config, name); },
          py::arg("name"))
      .def(
          "__setitem__",
          [](ConfigObject& self, const std::string& name, const py::object& value) {
            set(self.config, name, value);
          },
          py::arg("name"), py::arg("value"))
      .def(
          "__contains__",
          [](ConfigObject& self, const std::string& name) {
            return OptionList::of(self.config).find(name) != nullptr;
          },
          py::arg("name"))
      .def("__iter__", [](ConfigObject& self) { return py::iter(names(self.config)); })
      .def("__len__", [](ConfigObject& self) { return names(self.config).size(); })
      .def(
          "keys", [](ConfigObject& self) { return names(self.config); },
          "The options' names, in their order.")
      .def(
          "describe",
          [](ConfigObject& self, const std::string& name) { return described(self.config, name); },
          py::arg("name"), "Unit, meaning and bounds of an option, in one line.")
      .def("read", &read_file, py::arg("file"),
           R"(Sets the options that a YAML file names and leaves the others as they are.

Raises Error, which names file, line and option; nothing has changed then.)")
      .def(
          "to_yaml",
          [](ConfigObject& self) { return option_file_text(OptionList::of(self.config)); },
          "All options as such a file, each with unit, meaning and bounds.")
      .def(
          "check", [](ConfigObject& self) { check(self.config); },
          "Raises ValueError for options that do not go together. Slam asks, too.")
      .def(
          "copy", [](const ConfigObject& self) { return self; },
          "Another one, with the same values.")
      .def("__repr__", [](ConfigObject& self) {
        return fmt::format("<dkp_slam.Config mode {}, {} options>",
                           std::string(py::str(get(self.config, "mode"))),
                           names(self.config).size());
      });
}

}  // namespace dkp_slam::python

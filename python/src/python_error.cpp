#include "python/src/python_error.h"

#include <fmt/format.h>

namespace dkp_slam::python {
namespace py = pybind11;

std::string plain_text(const py::object& object) { return py::str(object); }

std::string line_of(const py::error_already_set& error) {
  std::string text = fmt::format("{}: {}", plain_text(error.type().attr("__name__")),
                                 error.value() ? plain_text(error.value()) : "");
  for (char& c : text) c = c == '\n' ? ' ' : c;
  py::object trace = error.trace() ? py::object(error.trace()) : py::none();
  if (trace.is_none()) return text;
  while (!trace.attr("tb_next").is_none()) trace = trace.attr("tb_next");
  const py::object code = trace.attr("tb_frame").attr("f_code");
  const std::string file = plain_text(code.attr("co_filename"));
  return fmt::format("{} ({}:{})", text, file.substr(file.rfind('/') + 1),
                     plain_text(trace.attr("tb_lineno")));
}

}  // namespace dkp_slam::python

#include "python/src/mailbox.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

namespace dkp_slam::python {
namespace py = pybind11;
namespace {

constexpr std::size_t most_log_lines = 1000;  // while Python does not come to read them

struct Mailbox {
  std::mutex mutex;  // never held while Python runs
  std::vector<PyObject*> references;
  std::vector<std::pair<int, std::string>> log_lines;
  std::atomic<bool> call_pending{false};
  std::atomic<bool> closed{false};
};

/// Never destroyed: threads may outlive static objects.
Mailbox& mailbox() {
  static auto* const box = new Mailbox;
  return *box;
}

int deliver_when_called(void*) {
  mailbox().call_pending = false;
  deliver();
  return 0;
}

void ask_for_delivery() {
  Mailbox& box = mailbox();
  if (box.closed || box.call_pending.exchange(true)) return;
  // Full queue: the next call into the module does it.
  if (Py_AddPendingCall(deliver_when_called, nullptr) != 0) box.call_pending = false;
}

int raise(void* exception) {
  PyErr_SetObject(PyExceptionInstance_Class(exception), static_cast<PyObject*>(exception));
  Py_DECREF(static_cast<PyObject*>(exception));
  return -1;
}

/// Ctrl-C, or what else a program's handler of a signal raises to end it, may come while its log is
/// written. It is not the log's: the program gets it as soon as this call has ended.
void pass_on(py::error_already_set& error) {
  PyObject* const exception = error.value().inc_ref().ptr();
  if (Py_AddPendingCall(raise, exception) == 0) return;
  Py_DECREF(exception);
  error.discard_as_unraisable("the log of dkp_slam");
}

void log(const std::vector<std::pair<int, std::string>>& lines) {
  for (const auto& [level, text] : lines) {
    try {
      const py::object logger = py::module_::import("logging").attr("getLogger")("dkp_slam");
      logger.attr("log")(level, "%s", text);  // an argument: a '%' in the text is no format
    } catch (py::error_already_set& error) {
      if (!error.matches(PyExc_Exception)) {
        pass_on(error);
      } else {
        error.discard_as_unraisable("the log of dkp_slam");
      }
    }
  }
}

class PythonSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    leave_log_line(level_of(message.level), {message.payload.data(), message.payload.size()});
  }
  void flush_() override {}

 private:
  static int level_of(spdlog::level::level_enum level) {
    switch (level) {
      case spdlog::level::critical:
        return 50;
      case spdlog::level::err:
        return 40;
      case spdlog::level::warn:
        return 30;
      case spdlog::level::info:
        return 20;
      default:
        return 10;
    }
  }
};

}  // namespace

void leave_reference(PyObject* object) {
  if (object == nullptr) return;
  {
    const std::lock_guard lock(mailbox().mutex);
    mailbox().references.push_back(object);
  }
  ask_for_delivery();
}

void leave_log_line(int level, std::string text) {
  {
    const std::lock_guard lock(mailbox().mutex);
    if (mailbox().log_lines.size() >= most_log_lines) return;
    mailbox().log_lines.emplace_back(level, std::move(text));
  }
  ask_for_delivery();
}

void deliver() {
  std::vector<PyObject*> references;
  std::vector<std::pair<int, std::string>> log_lines;
  {
    const std::lock_guard lock(mailbox().mutex);
    references.swap(mailbox().references);
    log_lines.swap(mailbox().log_lines);
  }
  // What these run may come here again; it finds the box empty.
  for (PyObject* object : references) Py_DECREF(object);
  log(log_lines);
}

void close_mailbox() {
  deliver();
  mailbox().closed = true;
}

void log_to_python() {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("dkp_slam", std::make_shared<PythonSink>()));
}

}  // namespace dkp_slam::python

#pragma once

#include <Python.h>

#include <string>

namespace dkp_slam::python {

/// What the system's threads have for Python. They never take the GIL for it, so that a busy
/// interpreter does not slow them and nobody waits in a circle: they leave it here, and a thread
/// that holds the GIL takes it out, soon after (a pending call of the interpreter) or at the next
/// call into this module.

/// A reference that is needed no more. From any thread.
void leave_reference(PyObject* object);
/// A line for the logger "dkp_slam", `level` as in Python's logging. From any thread.
void leave_log_line(int level, std::string text);

/// Lets go of and logs what was left. With the GIL held.
void deliver();
/// Python ends: what is left from now on stays.
void close_mailbox();

/// Sends the system's messages to Python's logging, by `leave_log_line`.
void log_to_python();

}  // namespace dkp_slam::python

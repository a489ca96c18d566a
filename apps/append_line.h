#pragma once

#include <string>

namespace dkp_slam::apps {

/// Appends a line, with its end, to a file that was opened with O_APPEND, so that no kill can tear
/// it: the kernel looks for the signal between two pages of a write, so none crosses a page's end.
/// A comment (#) fills up what is left of a page. All of the line or nothing; false, and errno,
/// when it could not be written.
bool append_line(int file, const std::string& line);

}  // namespace dkp_slam::apps

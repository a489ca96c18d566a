#pragma once

#include <filesystem>
#include <string_view>

namespace dkp_slam {

/// Writes the whole file or leaves what was there: the content goes into a temporary file beside it
/// that then takes its name. A device or pipe is written to directly; of a symbolic link the target
/// is replaced. Throws `Error` when the file cannot be written.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Throws `Error` unless `write_file_atomically` could write here now. Leaves nothing behind: for
/// finding an unwritable output before a long computation, not after it.
void check_writable(const std::filesystem::path& path);

}  // namespace dkp_slam

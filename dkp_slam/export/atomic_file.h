#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace dkp_slam {

/// Writes the whole file or leaves what was there: the content goes into a file in the same folder
/// that takes its name when it is whole. Until then that has no name, so that nothing is left of it
/// if the process is killed; where the file system has no such files (NFS), it has that of the file
/// with `.PID.tmp` behind it. A device or pipe is written to directly; of a symbolic link the
/// target is replaced. Throws `Error` when the file cannot be written.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);
/// The same for content that is too long to be held in memory: `fill` writes it.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& fill);

/// Throws `Error` unless `write_file_atomically` could write here now. Leaves nothing behind: for
/// finding an unwritable output before a long computation, not after it.
void check_writable(const std::filesystem::path& path);

/// A text file that grows over a long time without taking memory, and appears whole or not at all.
/// Until it is saved it lies in a file beside it that has no name, so that nothing is left of it
/// however the process ends.
class GrowingFile {
 public:
  /// Throws `Error` when nothing can be written beside `path`.
  explicit GrowingFile(std::filesystem::path path);
  /// What goes wrong shows when it is saved.
  void append(std::string_view text);
  /// Calls `use` with each line appended so far, without its end.
  void for_each_line(const std::function<void(std::string_view)>& use);
  /// Writes what was appended so far to where it belongs, as `write_file_atomically` does.
  void save();

 private:
  void copy_to(std::ostream& out);

  std::filesystem::path path_;
  std::fstream stream_;
  std::string failure_;  // the first reason why something could not be appended
};

}  // namespace dkp_slam

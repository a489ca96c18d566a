#include "dkp_slam/export/atomic_file.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string_view reason) {
  throw Error(
      fmt::format("cannot write {}: {}; choose a place you may write to", path.string(), reason));
}

/// Follows symbolic links, so that a link is kept and its target replaced.
fs::path target_of(const fs::path& path) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target;
}

bool is_device(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_regular_file(path, error);
}

fs::path temporary_beside(const fs::path& path) {
  fs::path temporary = path;
  temporary += fmt::format(".{}.tmp", ::getpid());
  return temporary;
}

/// Throws for what opening the file would report less clearly.
void check_place(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) fail(path, "it is a folder");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    fail(path, fmt::format("the folder {} does not exist", folder.string()));
  }
}

/// A file without a name in the folder of `target`, so that nothing is left of it however the
/// process ends. Not every file system has such files: network and stacked ones may not.
class NamelessFile {
 public:
  explicit NamelessFile(const fs::path& target)
      : file_(::open(target.has_parent_path() ? target.parent_path().c_str() : ".",
                     O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666)),
        path_(fmt::format("/proc/self/fd/{}", file_)) {}
  ~NamelessFile() {
    if (file_ >= 0) ::close(file_);
  }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  bool exists() const { return file_ >= 0 && ::access(path_.c_str(), W_OK) == 0; }
  /// Where others may open it.
  const fs::path& path() const { return path_; }

  /// False, with `errno` set, where it cannot have this name; no file that is there is replaced.
  bool take_name(const fs::path& name) const {
    return ::linkat(AT_FDCWD, path_.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  }

 private:
  int file_;
  fs::path path_;
};

using Fill = std::function<void(std::ostream&)>;

void write_directly(const fs::path& file, const fs::path& named, const Fill& fill) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  fill(stream);
  stream.close();
  if (!stream) fail(named, errno != 0 ? std::strerror(errno) : "writing failed");
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view content) {
  write_file_atomically(path, [content](std::ostream& stream) {
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

void write_file_atomically(const fs::path& path, const Fill& fill) {
  check_place(path);
  if (is_device(path)) {
    write_directly(path, path, fill);
    return;
  }
  const fs::path target = target_of(path);
  const fs::path temporary = temporary_beside(target);
  std::error_code ignored;
  fs::remove(temporary, ignored);  // of a process that had this number before
  try {
    const NamelessFile nameless(target);
    write_directly(nameless.exists() ? nameless.path() : temporary, path, fill);
    if (nameless.exists()) {
      if (nameless.take_name(target)) return;
      // Only a renaming replaces a file: for a moment what is whole has the temporary name.
      if (!nameless.take_name(temporary)) fail(path, std::strerror(errno));
    }
  } catch (...) {  // memory may have run out as well
    fs::remove(temporary, ignored);
    throw;
  }
  std::error_code error;
  fs::rename(temporary, target, error);
  if (error) {
    fs::remove(temporary, ignored);
    fail(path, error.message());
  }
}

void check_writable(const fs::path& path) {
  check_place(path);
  if (is_device(path)) {
    if (::access(path.c_str(), W_OK) != 0) fail(path, std::strerror(errno));
    return;
  }
  const fs::path target = target_of(path);
  if (NamelessFile(target).exists()) return;
  const fs::path temporary = temporary_beside(target);
  write_directly(temporary, path, [](std::ostream&) {});
  std::error_code ignored;
  fs::remove(temporary, ignored);
}

GrowingFile::GrowingFile(fs::path path) : path_(std::move(path)) {
  check_place(path_);
  const NamelessFile nameless(path_);
  const fs::path temporary = nameless.exists() ? nameless.path() : temporary_beside(path_);
  errno = 0;
  stream_.open(temporary, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  if (!stream_) fail(path_, std::strerror(errno));
  std::error_code ignored;
  if (!nameless.exists()) fs::remove(temporary, ignored);
}

void GrowingFile::append(std::string_view text) {
  if (!failure_.empty()) return;
  errno = 0;
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) failure_ = errno != 0 ? std::strerror(errno) : "writing failed";
}

void GrowingFile::for_each_line(const std::function<void(std::string_view)>& use) {
  stream_.seekg(0);
  for (std::string line; std::getline(stream_, line);) use(line);
  stream_.clear();
  stream_.seekp(0, std::ios::end);
}

void GrowingFile::save() {
  errno = 0;
  if (!stream_.flush() && failure_.empty()) failure_ = std::strerror(errno);
  if (!failure_.empty()) fail(path_, failure_);
  write_file_atomically(path_, [this](std::ostream& out) { copy_to(out); });
}

void GrowingFile::copy_to(std::ostream& out) {
  stream_.seekg(0);
  std::array<char, 1 << 16> piece;
  while (stream_.read(piece.data(), piece.size()) || stream_.gcount() > 0) {
    out.write(piece.data(), stream_.gcount());
  }
  if (stream_.bad()) out.setstate(std::ios::badbit);
  stream_.clear();
  stream_.seekp(0, std::ios::end);
}

}  // namespace dkp_slam

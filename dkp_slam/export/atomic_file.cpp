#include "dkp_slam/export/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

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

void write_directly(const fs::path& file, const fs::path& named, std::string_view content) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) fail(named, errno != 0 ? std::strerror(errno) : "writing failed");
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view content) {
  check_place(path);
  if (is_device(path)) {
    write_directly(path, path, content);
    return;
  }
  const fs::path target = target_of(path);
  const fs::path temporary = temporary_beside(target);
  std::error_code ignored;
  try {
    write_directly(temporary, path, content);
  } catch (const Error&) {
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
  const fs::path temporary = temporary_beside(target_of(path));
  write_directly(temporary, path, "");
  std::error_code ignored;
  fs::remove(temporary, ignored);
}

}  // namespace dkp_slam

#include "apps/append_line.h"

#include <cerrno>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace dkp_slam::apps {
namespace {

/// Appends all of the text or nothing.
bool append(int file, std::string_view text) {
  struct stat before {};
  if (::fstat(file, &before) != 0) return false;
  const ssize_t written = ::write(file, text.data(), text.size());
  if (written == static_cast<ssize_t>(text.size())) return true;
  const int reason = written < 0 ? errno : ENOSPC;
  if (written > 0 && ::ftruncate(file, before.st_size) != 0) return false;
  errno = reason;
  return false;
}

}  // namespace

bool append_line(int file, const std::string& line) {
  constexpr std::size_t page = 4096;
  struct stat now {};
  if (::fstat(file, &now) != 0) return false;
  const std::size_t left = page - static_cast<std::size_t>(now.st_size) % page;
  // One byte that is left could not be made a comment.
  if (line.size() != left && line.size() + 2 > left &&
      !append(file, fmt::format("#{:{}}\n", "", left - 2))) {
    return false;
  }
  return append(file, line);
}

}  // namespace dkp_slam::apps

#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "dkp_slam/error.h"

namespace dkp_slam {

/// Why a file cannot be read whole, in a few words; empty when it can. Asked before it is opened:
/// opening a pipe waits for a writer, a device may never end, and a folder opens like a file.
inline std::string why_unreadable(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  namespace fs = std::filesystem;
  constexpr std::uintmax_t megabyte = 1'000'000;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error) return error.message();
  if (fs::is_directory(status)) return "it is a folder";
  if (!fs::is_regular_file(status)) return "it is a pipe or a device, not a file";
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) return error.message();
  if (bytes <= most_bytes) return "";
  return "it has " + std::to_string(bytes / megabyte) + " MB, more than " +
         std::to_string(most_bytes / megabyte) + " MB";
}

/// A text file to be read whole. Throws `Error` "PATH: PROBLEM: why; REMEDY".
inline std::ifstream open_text(const std::filesystem::path& path, std::uintmax_t most_bytes,
                               const std::string& problem, const std::string& remedy) {
  const std::string reason = why_unreadable(path, most_bytes);
  std::ifstream stream;
  if (reason.empty()) stream.open(path);
  if (stream.is_open()) return stream;
  throw Error(path.string() + ": " + problem + (reason.empty() ? "" : ": ") + reason + "; " +
              remedy);
}

}  // namespace dkp_slam

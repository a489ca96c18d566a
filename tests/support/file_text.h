#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace dkp_slam::testing {

/// The file's bytes; none where it cannot be opened.
inline std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace dkp_slam::testing

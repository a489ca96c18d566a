#pragma once

#include <filesystem>
#include <string>

namespace dkp_slam::bench {

/// A hash of a file's content: tells one build of a program from another. Throws `Error` when the
/// file cannot be read.
std::string fingerprint(const std::filesystem::path& path);

}  // namespace dkp_slam::bench

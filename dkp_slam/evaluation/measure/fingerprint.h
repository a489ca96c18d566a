#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace dkp_slam {

/// A hash of a file's content: tells one build of a program from another. Throws `Error` when the
/// file cannot be read.
std::string fingerprint(const std::filesystem::path& path);

/// The same hash of a text.
std::string text_fingerprint(std::string_view text);

}  // namespace dkp_slam

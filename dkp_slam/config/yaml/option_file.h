#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {

/// Sets the options that a YAML file names, part by part, and leaves the others as they are:
///
///     tracking:
///       local_keyframes: 60
///
/// Throws `Error`, "FILE:LINE: ...", for a file that cannot be read, is empty or no map, and for a
/// name that is unknown or given twice, a value of the wrong type, or one out of bounds. Some
/// options have been set by then.
void read_option_file(const std::filesystem::path& file, OptionList& options);

/// All options as such a file, each with a comment that gives unit, meaning and bounds.
std::string option_file_text(const OptionList& options);

}  // namespace dkp_slam

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dkp_slam/sensor/tum_lists.h"

namespace dkp_slam {

/// Files by the numbers in their names, in the order of the numbers' values.
using NumberedFiles = std::map<std::uint64_t, std::string>;

/// Files directly in `folder` called PREFIX, digits, one of the endings; other files are left out.
/// Names without the folder. Empty where there is no such folder. Throws `Error` where two have one
/// number (7.png and 007.png).
NumberedFiles numbered_files(const std::filesystem::path& folder, std::string_view prefix,
                             const std::vector<std::string_view>& endings);

/// Pairs of the same number at number / `rate` seconds, `colour_folder` and `depth_folder` before
/// the names. A number that one kind alone has is left out, and said. Throws `Error` where no pair
/// is left; `folder` is for messages.
std::vector<ImagePair> pair_by_number(const std::filesystem::path& folder,
                                      const std::filesystem::path& colour_folder,
                                      const NumberedFiles& colour,
                                      const std::filesystem::path& depth_folder,
                                      const NumberedFiles& depth, double rate);

}  // namespace dkp_slam

#include "dkp_slam/sensor/layout/numbered_images.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

/// The number between prefix and ending; nothing where the name has another form.
std::optional<std::uint64_t> number_in(std::string_view name, std::string_view prefix,
                                       const std::vector<std::string_view>& endings) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  const auto ending = std::find_if(endings.begin(), endings.end(),
                                   [name](std::string_view e) { return name.ends_with(e); });
  if (ending == endings.end()) return std::nullopt;
  name.remove_suffix(ending->size());
  // Time stamps are doubles in microseconds: a number of more digits is no count of images.
  constexpr std::size_t most_digits = 12;
  if (name.empty() || name.size() > most_digits) return std::nullopt;
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return number;
}

}  // namespace

NumberedFiles numbered_files(const fs::path& folder, std::string_view prefix,
                             const std::vector<std::string_view>& endings) {
  NumberedFiles files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    const auto number = number_in(name, prefix, endings);
    if (!number) continue;
    if (const auto [first, added] = files.emplace(*number, name); !added) {
      throw Error(fmt::format("{}: {} and {} have one number; remove one of them", folder.string(),
                              std::min(first->second, name), std::max(first->second, name)));
    }
  }
  return files;
}

std::vector<ImagePair> pair_by_number(const fs::path& folder, const fs::path& colour_folder,
                                      const NumberedFiles& colour, const fs::path& depth_folder,
                                      const NumberedFiles& depth, double rate) {
  std::vector<ImagePair> pairs;
  for (const auto& [number, name] : colour) {
    const auto partner = depth.find(number);
    if (partner == depth.end()) continue;
    const double stamp = static_cast<double>(number) / rate;
    pairs.push_back({stamp, colour_folder / name, depth_folder / partner->second, stamp, ""});
  }
  if (pairs.empty()) {
    throw Error(
        fmt::format("{}: none of {} colour images has the number of one of {} depth images; is "
                    "part of the sequence missing?",
                    folder.string(), colour.size(), depth.size()));
  }
  if (pairs.size() < std::max(colour.size(), depth.size())) {
    spdlog::warn(
        "{}: {} colour images without depth and {} depth images without colour are left "
        "out",
        folder.string(), colour.size() - pairs.size(), depth.size() - pairs.size());
  }
  return pairs;
}

}  // namespace dkp_slam

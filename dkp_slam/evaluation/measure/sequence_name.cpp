#include "dkp_slam/evaluation/measure/sequence_name.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 6> paper_names = {
    {{"walking_halfsphere", "W/half"},
     {"walking_rpy", "W/rpy"},
     {"walking_static", "W/static"},
     {"walking_xyz", "W/xyz"},
     {"sitting_static", "S/static"},
     {"sitting_xyz", "S/xyz"}}};

std::optional<std::string> paper_name(const std::string& motion) {
  for (const auto& [name, short_name] : paper_names) {
    if (motion == name) return short_name;
  }
  return std::nullopt;
}

}  // namespace

std::string camera_file(const std::string& sequence) {
  for (const char digit : {'1', '2', '3'}) {
    if (sequence.starts_with(fmt::format("rgbd_dataset_freiburg{}_", digit))) {
      return fmt::format("tum_fr{}.yaml", digit);
    }
  }
  if (sequence.starts_with("rgbd_bonn_")) return "bonn.yaml";
  throw Error(sequence +
              ": its name is none of a benchmark's (rgbd_dataset_freiburg1_..., rgbd_bonn_...), so "
              "its camera must be given");
}

std::optional<PaperSequence> paper_sequence(const std::string& sequence,
                                            const std::string& scenario) {
  if (!scenario.empty()) {
    if (const auto name = paper_name(scenario)) return PaperSequence{*name, true};
    return std::nullopt;
  }
  for (const std::string prefix : {"rgbd_dataset_freiburg3_", "freiburg3_", "fr3_"}) {
    if (!sequence.starts_with(prefix)) continue;
    if (const auto name = paper_name(sequence.substr(prefix.size()))) {
      return PaperSequence{*name, false};
    }
    return std::nullopt;
  }
  if (const auto name = paper_name(sequence)) return PaperSequence{*name, true};
  return std::nullopt;
}

}  // namespace dkp_slam

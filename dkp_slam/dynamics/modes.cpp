#include "dkp_slam/dynamics/modes.h"

#include <algorithm>
#include <cassert>

#include "dkp_slam/error.h"

namespace dkp_slam {

const std::vector<ModeInfo>& dynamics_modes() {
  // The tracker is the same in all modes but the paper's, so that they differ in dynamics alone.
  static const std::vector<ModeInfo> modes = {
      {DynamicsMode::off, "off", "nothing", true, false},
      {DynamicsMode::masks, "masks", "what the masks hold that come with the images", true, false},
      {DynamicsMode::paper, "paper", "what the paper's text removes, to the letter", false, true},
      {DynamicsMode::d, "d", "boxes", true, true},
      {DynamicsMode::dk, "dk", "clustered masks", true, true},
      {DynamicsMode::dkp, "dkp", "by region weight times epipolar distance", true, true},
      {DynamicsMode::dkp_plus, "dkp+", "masks, and what is seen to move", true, true}};
  return modes;
}

const ModeInfo& mode_info(DynamicsMode mode) {
  const auto& modes = dynamics_modes();
  const auto found =
      std::find_if(modes.begin(), modes.end(), [&](const ModeInfo& m) { return m.mode == mode; });
  assert(found != modes.end());
  return *found;
}

std::string mode_names() {
  std::string names;
  for (const ModeInfo& m : dynamics_modes()) {
    names += names.empty() ? "{" : ",";
    names += m.name;
  }
  return names + "}";
}

DynamicsMode mode_named(const std::string& name) {
  for (const ModeInfo& m : dynamics_modes()) {
    if (m.name == name) return m.mode;
  }
  throw Error("no mode \"" + name + "\"; there are " + mode_names());
}

}  // namespace dkp_slam

#pragma once

#include <string>
#include <vector>

namespace dkp_slam {

/// How dynamic points are removed: the paper to the letter, the ablation of its Table 6, and ours.
/// What each is made of: parts.h, docs/modes.md.
enum class DynamicsMode {
  off,       ///< nothing is removed: the plain RGB-D SLAM baseline
  masks,     ///< what somebody else's segmentation holds, RgbdFrame::mask, and nothing else
  paper,     ///< the paper's text as it stands, whatever it costs
  d,         ///< all features in boxes go; missed detections are compensated
  dk,        ///< all features in the clustered masks go
  dkp,       ///< region weight times epipolar distance (Algorithm 2)
  dkp_plus,  ///< ours: masks with their outlines, and what is seen to move
};

/// What is known of a mode beside its parts.
struct ModeInfo {
  DynamicsMode mode;
  const char* name;     ///< as the user writes it: "dkp+"
  const char* removes;  ///< in a few words
  bool own_tracking;    ///< whether it tracks by more than the text: landmarks' belief, refill
  bool detector;        ///< whether it uses one
};

/// All modes, the plainest first.
const std::vector<ModeInfo>& dynamics_modes();
const ModeInfo& mode_info(DynamicsMode mode);
/// "{off,masks,paper,d,dk,dkp,dkp+}", for help texts.
std::string mode_names();
/// Throws `Error` that lists the modes when there is none of this name.
DynamicsMode mode_named(const std::string& name);

}  // namespace dkp_slam

#pragma once

#include <memory>
#include <vector>

#include "dkp_slam/synth/mesh/actor.h"
#include "dkp_slam/synth/path/motion.h"
#include "dkp_slam/synth/render/rendering.h"
#include "dkp_slam/synth/room/furniture.h"

namespace dkp_slam {

/// What there is, what happens, and how the camera moves in a synthetic sequence.
struct Scenario {
  Place place;
  std::vector<std::shared_ptr<const Actor>> actors;  ///< all that moves at any time
  LampBrightness brightness;                         ///< null: the lamps stay on
  CameraPath camera;
  bool drops_frames = false;
};

}  // namespace dkp_slam

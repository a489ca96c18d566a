#pragma once

#include <cstdint>

#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/system/back_end.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// Everything that decides a run's result, beside the images.
struct SlamConfig {
  Camera camera;
  DynamicsOptions dynamics;
  OrbOptions orb;
  MeasurementModel measurement;
  TrackerOptions tracker;
  BackEndOptions back_end;
  /// Adjust the whole map once more at the end, before poses are written.
  bool final_adjustment = true;
  bool realtime = false;
  bool localize_only = false;  ///< in a stored map, which stays as it is
  std::uint64_t seed = 1;
};

}  // namespace dkp_slam

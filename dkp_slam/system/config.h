#pragma once

#include <cstdint>

#include "dkp_slam/detection/options/detector_options.h"
#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/loop/loop_closer.h"
#include "dkp_slam/mapping/mapper.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/system/feature_refill.h"
#include "dkp_slam/tracking/path_smoother.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// Everything that decides a run's result, beside the images. A file gives all of it but the
/// camera, each field under its own name (config/yaml/option_file.h): "tracking.local_keyframes".
struct SlamConfig {
  Camera camera;
  DetectorOptions detector;  ///< for make_detector: the system is handed the detector itself
  DynamicsOptions dynamics;
  OrbOptions orb;
  FeatureRefillOptions refill;
  MeasurementModel measurement;
  PlaceIndexOptions places;
  TrackerOptions tracking;
  PathSmootherOptions path;
  MapperOptions mapping;
  LoopCloserOptions loop;
  bool close_loops = true;
  /// Adjust the whole map once more at the end, before poses are written.
  bool final_adjustment = true;
  bool realtime = false;
  bool localize_only = false;  ///< in a stored map, which stays as it is
  std::uint64_t seed = 1;

  void describe(OptionList& list);
  /// Of all parts, but for the camera, which checks itself. Throws `Error`, which names field,
  /// value and bound.
  void check() const;
};

}  // namespace dkp_slam

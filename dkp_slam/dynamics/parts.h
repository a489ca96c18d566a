#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dkp_slam/dynamics/compensation/flow_compensation.h"
#include "dkp_slam/dynamics/compensation/object_tracker.h"
#include "dkp_slam/dynamics/dynamics_options.h"
#include "dkp_slam/dynamics/given_masks.h"
#include "dkp_slam/dynamics/masks/mask_cutter.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/dynamics/motion/moving_surfaces.h"
#include "dkp_slam/dynamics/removal/feature_classifier.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/planes/static_planes.h"

namespace dkp_slam {

/// What a mode is made of; a part that it does without is null or false.
struct DynamicsParts {
  std::unique_ptr<ObjectTracker> objects;          ///< §3.3: boxes from frame to frame
  std::unique_ptr<FeatureMotionEstimator> motion;  ///< flow of the features
  bool follow_some = false;    ///< of the features where nothing is known to move
  bool ego_motion = false;     ///< measured from what is static: predicts, undoes the shutter
  bool long_baseline = false;  ///< residuals over `FeatureMotionOptions::long_baseline` as well
  std::unique_ptr<StaticPlanes> planes;                 ///< tables, floor, walls
  std::unique_ptr<StaticBackground> background;         ///< what stood there before they came
  std::unique_ptr<MaskCutter> masks;                    ///< §3.4: an object in its box
  std::unique_ptr<MovingSurfaces> surfaces;             ///< what moves on its own accord
  std::unique_ptr<FeatureClassifier> classifier;        ///< §3.5: static or not
  std::unique_ptr<FlowCompensation> flow_compensation;  ///< §3.3 as printed, for missed frames
  std::unique_ptr<GivenMasks> given_masks;              ///< in place of objects and their masks

  /// Names of the parts that are there, in the order in which they work.
  std::vector<std::string> names() const;
};

/// The options as the mode uses them: `paper` has the paper's own choices where ours are others.
DynamicsOptions options_of_mode(const DynamicsOptions& options);

/// The one place where a mode is put together; no part knows which mode it works in.
DynamicsParts make_parts(const Camera& camera, const DynamicsOptions& given);

}  // namespace dkp_slam

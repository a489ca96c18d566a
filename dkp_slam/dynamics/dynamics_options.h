#pragma once

#include "dkp_slam/dynamics/compensation/object_tracker.h"
#include "dkp_slam/dynamics/masks/clustering.h"
#include "dkp_slam/dynamics/masks/mask_depth_choice.h"
#include "dkp_slam/dynamics/masks/static_background.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/dynamics/motion/moving_surfaces.h"
#include "dkp_slam/dynamics/removal/epipolar.h"
#include "dkp_slam/dynamics/removal/regions.h"
#include "dkp_slam/dynamics/removal/removal_options.h"
#include "dkp_slam/geometry/planes/static_planes.h"

namespace dkp_slam {

class OptionList;

struct DynamicsOptions {
  DynamicsMode mode = DynamicsMode::dkp_plus;
  ClusteringOptions clustering;
  MaskDepthOptions mask_depth;
  StaticPlanesOptions static_planes;
  StaticBackgroundOptions background;
  ObjectTrackerOptions compensation;
  MotionHistoryOptions history;
  FeatureMotionOptions motion;
  MovingSurfaceOptions surfaces;
  EpipolarOptions epipolar;
  RegionOptions regions;
  RemovalOptions removal;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam

#include "dkp_slam/dynamics/parts.h"

#include <limits>

#include "dkp_slam/dynamics/removal/epipolar_rule.h"
#include "dkp_slam/dynamics/removal/region_rules.h"
#include "dkp_slam/dynamics/removal/residual_rule.h"

namespace dkp_slam {
namespace {

/// The paper's own choices where the options are ours.
DynamicsOptions as_printed(DynamicsOptions options) {
  options.compensation.compensate = false;  // the box is not carried
  options.motion.coarse_rotation = false;
  options.clustering.mode = ClusteringMode::paper;
  options.epipolar.min_low_matches = std::numeric_limits<int>::max();  // F from all matches
  options.regions.printed_equation = true;
  options.regions.weight_high = 10.0F;  // "W ranging from 1 to 10"
  return options;
}

DynamicsParts paper_parts(Camera camera, const DynamicsOptions& options) {
  camera.readout = 0.0;  // the paper knows of no rolling shutter
  DynamicsParts parts;
  parts.objects = std::make_unique<ObjectTracker>(options.compensation);
  parts.motion = std::make_unique<FeatureMotionEstimator>(camera, options.motion);
  parts.masks = std::make_unique<MaskCutter>(options.clustering, camera.fx);
  parts.classifier =
      std::make_unique<EpipolarRule>(options.epipolar, options.regions, options.removal.epsilon);
  parts.flow_compensation = std::make_unique<FlowCompensation>(options.motion.motion);
  return parts;
}

/// What d, dk, dkp and dkp+ have in common: everything but the rule that removes features.
DynamicsParts common_parts(const Camera& camera, const DynamicsOptions& options) {
  DynamicsParts parts;
  parts.objects = std::make_unique<ObjectTracker>(options.compensation);
  parts.motion = std::make_unique<FeatureMotionEstimator>(camera, options.motion);
  parts.ego_motion = true;
  parts.follow_some = true;
  parts.planes = std::make_unique<StaticPlanes>(options.static_planes, options.clustering.planes);
  parts.background = std::make_unique<StaticBackground>(camera, options.background);
  parts.masks = std::make_unique<MaskCutter>(options.clustering, camera.fx);
  return parts;
}

DynamicsParts given_parts(const Camera& camera, const DynamicsOptions& options) {
  DynamicsParts parts;
  parts.given_masks = std::make_unique<GivenMasks>(options.compensation.carry_seconds);
  parts.motion = std::make_unique<FeatureMotionEstimator>(camera, options.motion);
  parts.ego_motion = true;
  parts.classifier = std::make_unique<GivenMaskRule>(options.removal.given_margin);
  return parts;
}

}  // namespace

DynamicsOptions options_of_mode(const DynamicsOptions& options) {
  return options.mode == DynamicsMode::paper ? as_printed(options) : options;
}

DynamicsParts make_parts(const Camera& camera, const DynamicsOptions& given) {
  const DynamicsOptions options = options_of_mode(given);
  if (options.mode == DynamicsMode::off) return {};
  if (options.mode == DynamicsMode::paper) return paper_parts(camera, options);
  if (options.mode == DynamicsMode::masks) return given_parts(camera, options);
  DynamicsParts parts = common_parts(camera, options);
  switch (options.mode) {
    case DynamicsMode::d:
      parts.classifier = std::make_unique<BoxRule>();
      break;
    case DynamicsMode::dk:
      parts.classifier = std::make_unique<MaskRule>();
      break;
    case DynamicsMode::dkp:
      parts.follow_some = false;  // its F is of all matches
      parts.classifier = std::make_unique<EpipolarRule>(options.epipolar, options.regions,
                                                        options.removal.epsilon);
      break;
    default:
      parts.long_baseline = true;
      parts.surfaces = std::make_unique<MovingSurfaces>(options.surfaces);
      parts.classifier = std::make_unique<ResidualRule>(options.removal);
      break;
  }
  return parts;
}

std::vector<std::string> DynamicsParts::names() const {
  std::vector<std::string> all;
  const auto add = [&](bool there, const char* name) {
    if (there) all.emplace_back(name);
  };
  add(objects && !objects->carries(), "object tracker");
  add(objects && objects->carries(), "object tracker with carried boxes");
  add(given_masks != nullptr, "given masks");
  add(motion != nullptr, "flow");
  add(ego_motion, "ego-motion");
  add(long_baseline, "long baseline");
  add(planes != nullptr, "static planes");
  add(background != nullptr, "static background");
  if (masks) all.push_back(masks->name());
  add(surfaces != nullptr, "moving surfaces");
  if (classifier) all.push_back(classifier->name());
  add(flow_compensation != nullptr, "flow compensation");
  return all;
}

}  // namespace dkp_slam

#pragma once

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/bundle_adjustment.h"

namespace dkp_slam {

class OptionList;

struct LocalBundleOptions {
  int window = 16;   ///< keyframes that move: the newest and those that share most with it
  int anchors = 24;  ///< keyframes that stay: the others that see most of the same landmarks

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Snapshot of the map about a keyframe: it and its neighbours move, all else that sees their
/// landmarks stays.
BundleProblem local_bundle(const Map& map, const MeasurementModel& model, int keyframe,
                           const LocalBundleOptions& options);

/// Carries a solution back: poses, positions, and outlier sightings removed. Keyframes and
/// landmarks that have gone since are passed over.
void apply_bundle(Map& map, const BundleProblem& problem, const BundleSolution& solution);

}  // namespace dkp_slam

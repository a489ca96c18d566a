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

/// Snapshot of all of one map; its first keyframe stays.
BundleProblem full_bundle(const Map& map, const MeasurementModel& model, int which);

/// Carries a solution back: poses, positions, and outlier sightings removed. Keyframes and
/// landmarks that have gone since are passed over.
void apply_bundle(Map& map, const BundleProblem& problem, const BundleSolution& solution);

/// Adjusts all of one map, here and now. Where `stop` is set before it is done, the map stays as it
/// was.
void adjust_map(Map& map, const MeasurementModel& model, int which, int iterations,
                const std::atomic<bool>* stop = nullptr);

/// `apply_bundle` for a whole map that has grown since the snapshot: keyframes that came later keep
/// their place relative to their nearest ancestor in it, landmarks relative to the first keyframe
/// that sees them (Mur-Artal and Tardos 2017, "ORB-SLAM2", section III-C).
void apply_full_bundle(Map& map, const BundleProblem& problem, const BundleSolution& solution);

}  // namespace dkp_slam

#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam::testing {

/// What a run of the whole system came to.
struct Outcome {
  Trajectory path;
  std::vector<FrameResult> frames;
  int detector_failures = 0;

  /// Indices of the frames that were not localised.
  std::vector<int> lost() const {
    std::vector<int> indices;
    for (const FrameResult& f : frames) {
      if (!f.localised) indices.push_back(f.index);
    }
    return indices;
  }
  /// Share of the frames' features that was removed.
  double removed_share() const {
    double removed = 0.0, all = 0.0;
    for (const FrameResult& f : frames) {
      removed += f.removed_features;
      all += f.features;
    }
    return removed / all;
  }
};

inline Outcome run(std::unique_ptr<RgbdSource> source, std::unique_ptr<Detector> detector,
                   const Camera& camera, DynamicsMode mode) {
  SlamConfig options;
  options.camera = camera;
  options.dynamics.mode = mode;
  Slam slam(options, std::move(detector));
  Outcome outcome;
  play(*source, slam, {}, [&](const FrameResult& result) { outcome.frames.push_back(result); });
  outcome.path = slam.trajectory();
  outcome.detector_failures = slam.counters().detector_failures;
  return outcome;
}

inline std::unique_ptr<Detector> motion_detector(const Camera& camera) {
  DetectorOptions options;
  options.kind = DetectorKind::motion;
  return make_detector(options, camera);
}

}  // namespace dkp_slam::testing

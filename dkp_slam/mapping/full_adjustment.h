#pragma once

#include <cstddef>

#include "dkp_slam/map/map.h"
#include "dkp_slam/mapping/bundle_worker.h"

namespace dkp_slam {

class OptionList;

struct FullAdjustmentOptions {
  int iterations = 20;
  /// Frames from its start until it is carried back: this many and one more per keyframe. A fixed
  /// number makes the result independent of how fast the machine is: who arrives early waits.
  int delay = 30;
  /// A larger map is left to the pose graph: the solver would take more than a gigabyte, and be out
  /// of date before it was done.
  std::size_t most_sightings = 400000;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Bundle adjustment of a whole map in the background, after a loop was closed or maps were joined,
/// while tracking goes on. Called by the thread that the map belongs to.
class FullAdjustment {
 public:
  /// `realtime`: a result is carried back as soon as it is there, and never waited for.
  FullAdjustment(const Camera& camera, const MeasurementModel& model,
                 const FullAdjustmentOptions& options, bool realtime = false)
      : model_(model), options_(options), realtime_(realtime), worker_(camera, model) {}

  /// Starts on a map as it is now; one under way is stopped, since it knows nothing of what has
  /// changed.
  void start(const Map& map, int which, int frame_index);
  /// Whether there is a result to carry back now.
  bool due(int frame_index) const;
  /// Carries the result back, waiting for it where it must.
  void carry_back(Map& map);
  /// Stops the one under way, if any, and forgets it.
  void stop();

  /// Adjustments carried back so far.
  int done() const { return done_; }

 private:
  const MeasurementModel model_;
  const FullAdjustmentOptions options_;
  const bool realtime_;
  BundleWorker worker_;
  BundleProblem under_way_;
  int due_frame_ = 0;
  int done_ = 0;
};

}  // namespace dkp_slam

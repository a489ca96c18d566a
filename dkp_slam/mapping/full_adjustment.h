#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "dkp_slam/map/map.h"
#include "dkp_slam/mapping/full_bundle.h"
#include "dkp_slam/mapping/worker.h"

namespace dkp_slam {

class OptionList;

struct FullAdjustmentOptions {
  int iterations = 20;
  /// Frames from the snapshot until it is carried back: this many and one more per keyframe. A
  /// fixed number makes the result independent of how fast the machine is: who arrives early waits.
  int delay = 30;
  /// Of a larger map only the part about the loop is adjusted, and the rest left to the pose graph:
  /// the solver would take more than a gigabyte, and be out of date before it was done.
  std::size_t most_sightings = 400000;
  /// What one frame does at most, so that none waits for long (2,000 keyframes: about 1 ms each).
  std::size_t sightings_per_frame = 5000;  ///< that come into the snapshot
  std::size_t outliers_per_frame = 100;    ///< that leave the map

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Bundle adjustment of a whole map in the background, after a loop was closed or maps were joined,
/// while tracking goes on. Called by the thread that the map belongs to.
class FullAdjustment {
 public:
  /// `realtime`: a result is carried back as soon as it is there, and never waited for.
  FullAdjustment(const Camera& camera, const MeasurementModel& model,
                 const FullAdjustmentOptions& options, bool realtime = false);

  /// Starts on the map of a keyframe, about which it is adjusted first of all; one under way is
  /// stopped, since it knows nothing of what has changed.
  void start(const Map& map, int keyframe);
  /// To be called once per frame: a small part of what is under way.
  void advance(Map& map, int frame_index);
  /// Whether there is a result to carry back now.
  bool due(int frame_index) const;
  /// Carries the result back, waiting for it where it must.
  void carry_back(Map& map);
  /// Stops the one under way, if any, and forgets it.
  void stop();
  /// Removes all outliers that `advance` has left.
  void finish(Map& map) { remove_outliers(map, outliers_.size()); }

  /// Adjustments carried back so far.
  int done() const { return done_; }

 private:
  struct Outlier {
    int landmark, keyframe;
  };
  struct Solution {
    std::vector<BundleProblem::Pose> before, after;  // of the same keyframes, ascending
    std::vector<MapMove::Landmark> landmarks;        // ascending
    std::vector<Outlier> outliers;
    int first_later = 0;
    bool usable = false;
  };

  Solution solve(FullBundle bundle, const std::atomic<bool>& stop) const;
  void remove_outliers(Map& map, std::size_t most);

  const Camera camera_;
  const MeasurementModel model_;
  const FullAdjustmentOptions options_;
  const bool realtime_;
  std::optional<FullBundle> snapshot_;  // while it is being taken
  int due_frame_ = 0;
  std::deque<Outlier> outliers_;
  int done_ = 0;
  Worker<FullBundle, Solution> worker_;
};

/// Adjusts all of one map, here and now; see FullAdjustmentOptions::most_sightings. Where `stop` is
/// set before it is done, the map stays as it was.
void adjust_map(Map& map, const MeasurementModel& model, int which, int iterations,
                const std::atomic<bool>* stop = nullptr,
                std::size_t most_sightings = FullAdjustmentOptions().most_sightings);

}  // namespace dkp_slam

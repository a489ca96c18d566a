#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <vector>

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/bundle_adjustment.h"

namespace dkp_slam {

/// Snapshot of a whole map for its bundle adjustment, taken piece by piece: all at once would keep
/// a frame waiting. In between the map may change: what has gone by the time the solution is
/// carried back is passed over then.
class FullBundle {
 public:
  /// Of the map that the keyframe `centre` belongs to; where that has more sightings than
  /// `most_sightings`, of its keyframes nearest to `centre`, counted in steps from neighbour to
  /// neighbour.
  FullBundle(const Map& map, int centre,
             std::size_t most_sightings = std::numeric_limits<std::size_t>::max());

  /// Takes in keyframes until they have about so many sightings; true when all are in.
  bool gather(const Map& map, const MeasurementModel& model, std::size_t sightings);

  std::size_t keyframes() const { return poses_.size(); }
  std::size_t sightings() const { return sightings_.size(); }
  /// Whether keyframes of the map were left out.
  bool cut() const { return cut_; }
  /// Ids of keyframes that came after the snapshot begin with this one.
  int first_later() const { return static_cast<int>(pose_of_.size()); }

  /// What was gathered, in the order of ids. The map's first keyframe stays; where the map was cut,
  /// those stay that have neighbours outside.
  BundleProblem take() &&;

 private:
  struct Seen {
    int keyframe, landmark;
    Observation seen;
  };

  /// The next keyframe to take in, -1 when there is none.
  int next_keyframe(const Map& map);
  void take_in(const Map& map, const MeasurementModel& model, int keyframe);
  void fix_rim(const Map& map);

  int which_;
  std::size_t most_sightings_;
  std::vector<char> met_;     // by keyframe id: in the queue, or has been
  std::vector<int> pose_of_;  // by keyframe id, -1 for none
  std::vector<int> queue_;    // keyframes, breadth first
  std::size_t next_ = 0;      // of the queue
  int next_unconnected_ = 0;  // keyframe id to look at when the queue is empty
  bool cut_ = false;
  // Lists that never move what they hold: that alone would keep a frame waiting.
  std::vector<BundleProblem::Pose> poses_;
  std::deque<BundleProblem::Point> points_;
  std::deque<Seen> sightings_;
  std::vector<bool> has_point_;  // by landmark id
};

/// All of it at once; of one map, by number. Empty where the map is.
BundleProblem full_bundle(const Map& map, const MeasurementModel& model, int which,
                          std::size_t most_sightings = std::numeric_limits<std::size_t>::max());

}  // namespace dkp_slam

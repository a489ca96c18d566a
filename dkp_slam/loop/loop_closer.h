#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/loop/loop_detector.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/optimization/pose_graph.h"

namespace dkp_slam {

class OptionList;

struct LoopCloserOptions {
  LoopDetectorOptions detector;
  PoseGraphOptions graph;
  int least_matches = 40;  ///< landmarks of the old place that the new keyframe must show
  int least_shared = 100;  ///< landmarks that make two keyframes an edge of the essential graph
  /// Of a loop's edge against all others. Those repeat one and the same drift many times, as
  /// neighbours at every distance, and would outvote it.
  double loop_weight = 30.0;
  int fused_neighbours = 8;  ///< keyframes about the new one whose landmarks are fused as well

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A loop that was closed, or a place where two maps met.
struct ClosedLoop {
  int keyframe = -1, old_keyframe = -1;
  int matches = 0;     ///< landmarks of the old place found in the new keyframe
  double moved = 0.0;  ///< metres by which the new keyframe was put right; 0 where maps met
  bool joined_maps = false;
};

/// Closes loops and joins maps (Mur-Artal et al. 2015, section VII, with a scale that is known):
/// detection, alignment of the new keyframe to the landmarks of the old place, pose graph over the
/// essential graph, correction of the landmarks, and fusion of those that are the same. Where the
/// old place lies in another map, that map and this one become one instead, as they are.
///
/// Works on the map itself and so belongs to the tracking thread.
class LoopCloser {
 public:
  /// `seed`: of the alignment's RANSAC.
  explicit LoopCloser(const LoopCloserOptions& options = {}, std::uint64_t seed = 1)
      : options_(options), seed_(seed), detector_(options.detector) {}

  /// To be called with each new keyframe in turn, once it is in the map and the index. Closes a
  /// loop if there is one.
  std::optional<ClosedLoop> close(Map& map, const PlaceIndex& places, const MeasurementModel& model,
                                  int keyframe);

  const std::vector<ClosedLoop>& closed() const { return closed_; }

 private:
  struct LoopEdge {
    int from, to;
    Se3 to_from_from;
  };

  void join(Map& map, ClosedLoop& loop, const Frame& seen) const;
  void put_right(Map& map, ClosedLoop& loop, const Frame& seen);
  /// `node_of_keyframe`: index into the graph's nodes by keyframe, -1 for those not in this map.
  PoseGraph essential_graph(const Map& map, int which, std::vector<int>& node_of_keyframe) const;
  void correct(Map& map, int which) const;

  const LoopCloserOptions options_;
  const std::uint64_t seed_;
  LoopDetector detector_;
  std::vector<LoopEdge> loops_;
  std::vector<ClosedLoop> closed_;
};

}  // namespace dkp_slam
